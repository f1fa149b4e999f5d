// Catmull-Clark subdivision surfaces: points and normals of the limit surface of a cage of
// polygons.
#pragma once

#include <cstddef>

#include "tracer/polygon_mesh.h"

namespace weft {

/// The limit surface of `cage` at the corners of the faces that `levels` rounds of subdivision
/// make: quads, vertex 0 of each on the side of its parent's first corner, with unit normals. Open
/// borders keep their corners. Texcoords are left out.
/// @param levels      1 to 8.
/// @param kept_faces  only what the first `kept_faces` of the cage become is returned; the others
/// shape its border.
/// @throws Error      where the cage has no topology that can be subdivided.
PolygonMesh limit_surface(const PolygonMesh& cage, int levels,
                          std::size_t kept_faces = ~std::size_t{0});

}  // namespace weft
