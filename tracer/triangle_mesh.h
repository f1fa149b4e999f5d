// An indexed triangle mesh with a material a triangle: what mesostructures and scene shapes are
// made of.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "btf/vector.h"

namespace weft {

struct TriangleMesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  ///< one a vertex, unit; empty: shade with the triangles' own normals
  std::vector<Vec2> texcoords;  ///< one a vertex, or empty
  /// One a vertex or empty: unit dP/du at the vertex; not orthogonal to the normal by itself.
  std::vector<Vec3> tangents;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from outside
  std::vector<std::uint16_t> materials;  ///< one a triangle, index into `material_names`
  std::vector<std::string> material_names;
};

/// Whether any triangle is more than a line or a point.
inline bool has_area(const TriangleMesh& mesh) {
  return std::ranges::any_of(mesh.triangles, [&](const auto& t) {
    const Vec3& a = mesh.positions[t[0]];
    return ((mesh.positions[t[1]] - a) % (mesh.positions[t[2]] - a)).length2() > 0;
  });
}

}  // namespace weft
