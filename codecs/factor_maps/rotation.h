// Directions turned about the normal, by multiples of 1 / 64 of a circle.
#pragma once

#include "btf/hemisphere_sampling.h"

namespace weft::factor_maps {

/// Lights or views turned by minus `steps` of `rotation_steps`.
HemisphereSampling turned_back(const HemisphereSampling& sampling, int steps);

}  // namespace weft::factor_maps
