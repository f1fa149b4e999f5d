// Tessellates a surface that is given as a function of a grid's columns (along u) and rows (along
// v).
#pragma once

#include <functional>

#include "tracer/triangle_mesh.h"

namespace weft {

/// What a surface is at one vertex of its grid. `normal` and `tangent` = dP/du are unit; the normal
/// looks out.
struct SurfacePoint {
  Vec3 position;
  Vec3 normal;
  Vec3 tangent;
  Vec2 texcoord;
};

/// (columns + 1) x (rows + 1) vertices, each cell cut into two triangles that are counter-clockwise
/// where `normal` looks at the viewer; triangles with two corners in one place (at poles) are left
/// out.
/// @param surface  point of column 0 … columns and row 0 … rows.
TriangleMesh tessellate(int columns, int rows,
                        const std::function<SurfacePoint(int column, int row)>& surface);

/// Adds the vertices and triangles of `part` to `whole`; both have normals, texcoords and tangents.
void append(TriangleMesh& whole, const TriangleMesh& part);

}  // namespace weft
