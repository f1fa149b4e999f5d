#include "tracer/polygon_mesh.h"

namespace weft {

TriangleMesh triangulate(const PolygonMesh& mesh) {
  TriangleMesh result;
  result.positions = mesh.positions;
  result.normals = mesh.normals;
  result.texcoords = mesh.texcoords;
  result.material_names = mesh.material_names;
  const std::uint32_t* corner = mesh.corners.data();
  for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
    for (std::uint32_t k = 2; k < mesh.face_sizes[face]; ++k) {
      result.triangles.push_back({corner[0], corner[k - 1], corner[k]});
      result.materials.push_back(mesh.materials[face]);
    }
    corner += mesh.face_sizes[face];
  }
  return result;
}

}  // namespace weft
