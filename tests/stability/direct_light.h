// Direct light of a mesostructure by brute force, which shares nothing with the tracer above
// Embree.
#pragma once

#include <vector>

#include "acquisition/mesostructure.h"

namespace weft::test {

/// B in 1/sr of each texel, row by row, of a structure of triangles: it is laid out in as many
/// copies as rays towards this view and light can reach, and asked on a regular grid of `fine` x
/// `fine` points a texel.
/// @param albedo  of each material, Lambert.
/// @param size    texels a side.
std::vector<double> direct_light(const Mesostructure& structure, const std::vector<double>& albedo,
                                 const Direction& view, const Direction& light, int size, int fine);

}  // namespace weft::test
