// The scale map S solved anew against the data, once the maps are what will be decoded.
#pragma once

#include <vector>

#include "btf/btf.h"
#include "codecs/cmf/model.h"

namespace weft::cmf {

/// For each texel and channel the S that makes the sum over all pairs of (B - S P Q R
/// cos(theta_light))^2 least, [y][x][rgb]; 0 where P Q R is zero everywhere. Costs one more pass
/// over the data.
std::vector<float> least_squares_scale(const Btf& btf, const Model& model);

}  // namespace weft::cmf
