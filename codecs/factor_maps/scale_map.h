// The scale map S solved anew against the data, once the maps are what will be decoded.
#pragma once

#include <vector>

#include "codecs/factor_maps/model.h"
#include "codecs/factor_maps/texel_source.h"

namespace weft::factor_maps {

/// For each texel of every level and each channel the S >= 0 that makes the sum over all pairs of
/// (B - S product cos(theta_light))^2 least, [texel][rgb]; 0 where the product is zero everywhere.
/// `model.scale` is not read. Costs one more pass over the data.
std::vector<float> least_squares_scale(const TexelSource& source, const Model& model);

}  // namespace weft::factor_maps
