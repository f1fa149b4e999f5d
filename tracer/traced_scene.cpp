#include "tracer/traced_scene.h"

#include "btf/error.h"

namespace weft {
namespace {

std::vector<const TriangleMesh*> checked_meshes(const Scene& scene) {
  std::vector<const TriangleMesh*> meshes;
  for (const SceneShape& shape : scene.shapes) {
    const TriangleMesh& mesh = shape.mesh;
    const std::size_t vertices = mesh.positions.size();
    if (mesh.triangles.empty()) throw bad_input(shape.name, "the shape has no triangles");
    if (mesh.normals.size() != vertices || mesh.texcoords.size() != vertices ||
        mesh.tangents.size() != vertices) {
      throw bad_input(shape.name, "the shape lacks normals, texture coordinates or tangents");
    }
    if (shape.material >= scene.materials.size())
      throw bad_input(shape.name, "the shape has no material");
    meshes.push_back(&mesh);
  }
  if (meshes.empty()) throw bad_input("scene", "there is no shape to render");
  return meshes;
}

}  // namespace

TracedScene::TracedScene(const Scene& described)
    : scene(described), camera(described.camera), rays(checked_meshes(described)) {
  for (const EnvironmentLight& light : described.environments) environments.emplace_back(light);
}

}  // namespace weft
