// The best product of one function of the light and one of the view.
#pragma once

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

}  // namespace weft::cmf
