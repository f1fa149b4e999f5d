// Reads PLY through assimp.
#include "tracer/ply_file.h"

#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/Importer.hpp>

#include "btf/error.h"
#include "tracer/ply_length.h"

namespace weft {

namespace {

/// Adds a mesh of assimp's; texcoords and normals are kept only while every part has them.
void append(PolygonMesh& mesh, const aiMesh& part, const std::string& file) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& p = part.mVertices[i];
    mesh.positions.emplace_back(p.x, p.y, p.z);
    if (part.HasNormals()) {
      const aiVector3D& n = part.mNormals[i];
      mesh.normals.push_back(Vec3(n.x, n.y, n.z).normalized());
    }
    if (part.HasTextureCoords(0)) {
      const aiVector3D& t = part.mTextureCoords[0][i];
      mesh.texcoords.emplace_back(t.x, t.y);
    }
  }
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices < 3) {
      throw bad_input(
          file, fmt::format("face {} has {} corners, expected at least 3", f, face.mNumIndices));
    }
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      if (face.mIndices[k] >= part.mNumVertices) {
        throw bad_input(file, fmt::format("face {} names vertex {}, but there are {} vertices", f,
                                          static_cast<int>(face.mIndices[k]), part.mNumVertices));
      }
      mesh.corners.push_back(first + face.mIndices[k]);
    }
    mesh.face_sizes.push_back(face.mNumIndices);
    mesh.materials.push_back(0);
  }
}

}  // namespace

PolygonMesh read_ply(const std::filesystem::path& path) {
  require_whole_ply(path);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path.string(), 0);
  if (scene == nullptr) throw bad_input(path.string(), importer.GetErrorString());
  PolygonMesh mesh;
  mesh.material_names = {"default"};
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) append(mesh, *scene->mMeshes[i], path.string());
  if (mesh.normals.size() != mesh.positions.size()) mesh.normals.clear();
  if (mesh.texcoords.size() != mesh.positions.size()) mesh.texcoords.clear();
  return mesh;
}

}  // namespace weft
