// The shapes that a scene file may name, and how each is made.
//
// All are triangle meshes with normals, texcoords and tangents at every vertex. The frame at a hit
// is n = normalize(interpolated normals), t = normalize(T - n dot(n, T)), b = cross(n, t); v grows
// along +b on every shape made here. A mesh from a file with mirrored texcoords has v growing along
// -b there.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "settings/settings.h"
#include "tracer/triangle_mesh.h"

namespace weft {

struct ShapeType {
  std::string name;
  std::string summary;     ///< one line
  std::string parameters;  ///< lines "name = default   meaning"
  /// Reads the shape's own keys and makes it at the origin. @throws Error
  std::function<TriangleMesh(const Settings&)> make;
};

/// Every shape. The table is in shape_registry.cpp, a line a shape.
std::span<const ShapeType> shape_types();

/// Makes the shape of a table: `type` with its parameters, then placed by `scale` (number or three,
/// > 0), `rotate` (degrees about x, then y, then z) and `translate`, in this order.
/// @throws Error  with file:line, listing the valid names where the type is mistyped.
TriangleMesh make_shape(const Settings& settings);

}  // namespace weft
