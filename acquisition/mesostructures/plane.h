// A level plane across the tile.
#pragma once

#include "tracer/triangle_mesh.h"

namespace weft {

/// Adds [0, 1]^2 at a height (in tiles) as two triangles that face up; with normals where the mesh
/// is empty or has them.
void add_plane(TriangleMesh& mesh, float height, std::uint16_t material);

}  // namespace weft
