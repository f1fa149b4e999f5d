// Alternating over all three factors, for data that the chain's one pass leaves an error on.
#pragma once

#include <span>
#include <vector>

#include "codecs/cmf/lanes.h"
#include "codecs/cmf/parabolic_map.h"
#include "codecs/cmf/rank_one.h"

namespace weft::cmf {

/// Lowers sum over pairs of w_light (f - P Q R)^2 for `rounds` rounds: P and R by least squares
/// with the others held, Q's texels by the multiplicative update of Lee and Seung, which keeps them
/// >= 0. No factor grows beyond twice its largest value at the start, so that the maps stay fit
/// for 8 bits; but for that bound no step raises the error.
/// @param lookup         texels of `half` that each [light][view] pair asks for.
/// @param light_weights  w_light, > 0, one a light.
void refine(const LaneVector& f, std::span<const BilinearTaps> lookup,
            std::span<const double> light_weights, int rounds, LightView& factors,
            LaneVector& half);

}  // namespace weft::cmf
