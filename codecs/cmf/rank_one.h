// The best product of one function of the light and one of the view.
#pragma once

#include <span>

#include "codecs/cmf/lanes.h"

namespace weft::cmf {

/// f[light][view] ~ light * view.
struct LightView {
  LaneVector light;
  LaneVector view;
};

/// First singular pair of each lane's matrix (equation 5 with one term), all values >= 0. The scale
/// is in `light`, the largest of `view` is 1. A lane of zeros gives zeros.
LightView rank_one(const LaneVector& f, std::size_t n_lights, std::size_t n_views);

/// Lowers sum over pairs of w_light (f - P q R)^2 by `rounds` rounds of least squares, P with R
/// held and R with P held; each step is closed and never raises the error. With w = cos^2 that is
/// the error of B = f cos, the one that is seen: in terms of the residual f / q each pair weighs (q
/// cos)^2.
/// @param q              Q at each [light][view] pair.
/// @param light_weights  w_light, > 0, one a light.
LightView weighted_rank_one(const LaneVector& f, const LaneVector& q,
                            std::span<const double> light_weights, int rounds, LightView start);

}  // namespace weft::cmf
