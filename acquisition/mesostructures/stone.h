// One irregular stone as a closed mesh.
#pragma once

#include <cstdint>

#include "tracer/triangle_mesh.h"

namespace weft {

struct StoneForm {
  double radius;     ///< half the longest axis, about, in tiles
  double flatness;   ///< 1 - shortest / longest axis, below 1
  double roundness;  ///< 0.1: broken, with sharp edges, to 1: a pebble of a river
  double bumps;      ///< depth of the unevenness of its faces, in radii
};

/// A body of rounded plane faces around the origin, lying on its flat side: positions, triangles
/// and no normals. The body of distances c_k from the origin to planes of normals n_k is where
/// (sum_k max(0, x . n_k / c_k)^p)^(1/p) <= 1, with p = 4 / roundness: the polyhedron itself for p
/// without end. @param levels  of subdivision of an icosahedron: 20 * 4^levels triangles.
TriangleMesh make_stone(const StoneForm& form, int levels, std::uint64_t seed);

}  // namespace weft
