// Meshes of a tile that repeats without end: what meets across its border is one surface.
#pragma once

#include "tracer/polygon_mesh.h"

namespace weft {

/// Smooth normals, area-weighted over all triangles that meet at a point of the periodic plane (to
/// 1e-5 of a tile), those of the neighbouring tiles and those behind a seam too.
void set_periodic_normals(TriangleMesh& mesh);

/// The Catmull-Clark limit surface of a cage that repeats with period 1 in x and y: vertices that
/// are the same point of the periodic plane (to 1e-5 of a tile) are one, so there is no seam. See
/// `limit_surface`.
PolygonMesh periodic_limit_surface(const PolygonMesh& cage, int levels);

}  // namespace weft
