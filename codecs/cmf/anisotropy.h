// The direction into which an ABRDF is turned before its maps are clustered (paper 004, section 5:
// many factors are alike apart from a rotation).
#pragma once

#include <cstdint>
#include <vector>

#include "codecs/factor_maps/lanes.h"
#include "codecs/factor_maps/texel_source.h"

namespace weft::cmf {

/// For each texel of every level how many `factor_maps::rotation_steps` it is turned: the azimuth
/// of the principal axis of its half-vectors' second moments about the normal, each pair weighing
/// B, and of the axis' two ends the one on the side of the first moment; 0 for a texel without any.
/// The same for any number of threads. Costs a pass over the data.
std::vector<std::uint8_t> greatest_anisotropy(const factor_maps::TexelSource& source);

}  // namespace weft::cmf
