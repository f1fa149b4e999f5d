#include "acquisition/mesostructures/plane.h"

namespace weft {

void add_plane(TriangleMesh& mesh, float height, std::uint16_t material) {
  const bool with_normals = mesh.normals.size() == mesh.positions.size();
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec2& corner : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) {
    mesh.positions.emplace_back(corner.x, corner.y, height);
    if (with_normals) mesh.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  mesh.materials.insert(mesh.materials.end(), 2, material);
}

}  // namespace weft
