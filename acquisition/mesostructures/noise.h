// Gradient noise: smooth random variation, over the periodic tile or in space.
//
// K. Perlin, "Improving Noise", SIGGRAPH 2002: gradients at the corners of a lattice, mixed by
// 6 t^5 - 15 t^4 + 10 t^3; here with gradients hashed from the corners' coordinates.
#pragma once

#include <cstdint>

#include "btf/vector.h"

namespace weft {

/// Noise over the tile: `p` in tiles, `cells` lattice cells along each side, so that it repeats
/// with the tile. @returns about -0.7 to 0.7, of mean 0; 0 at the corners of the lattice.
double periodic_noise(const Imath::V2d& p, Imath::V2i cells, std::uint64_t seed);

/// Sum of `octaves` of periodic noise: each has twice the cells and half the size of the one
/// before.
double periodic_fractal_noise(const Imath::V2d& p, Imath::V2i cells, int octaves,
                              std::uint64_t seed);

/// Noise in space with unit cells, not periodic. @returns about -0.9 to 0.9, of mean 0.
double space_noise(const Imath::V3d& p, std::uint64_t seed);

}  // namespace weft
