// A mesh of polygons: what mesh files hold and what subdivision starts from.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tracer/triangle_mesh.h"

namespace weft {

struct PolygonMesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;              ///< one a vertex, unit, or empty
  std::vector<Vec2> texcoords;            ///< one a vertex, or empty
  std::vector<std::uint32_t> face_sizes;  ///< corners of each face, at least 3
  std::vector<std::uint32_t> corners;     ///< vertices of all faces, counter-clockwise from outside
  std::vector<std::uint16_t> materials;   ///< one a face, index into `material_names`
  std::vector<std::string> material_names;
};

/// Cuts every face into a fan around its first corner; a quad so from its first to its third.
TriangleMesh triangulate(const PolygonMesh& mesh);

}  // namespace weft
