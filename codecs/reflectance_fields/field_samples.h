// One reflectance field of the data: luminances over the lights, and the colour that they share.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "btf/btf.h"

namespace weft::reflectance_fields {

/// Numbers of the lights above the horizon; below it nothing is ever shown.
std::vector<std::size_t> lights_above_horizon(const HemisphereSampling& lights);

struct FieldSamples {
  std::vector<double> luminance;  ///< of each light asked for, over `largest`
  double largest = 0;             ///< of the luminances, 1/sr
  /// What a luminance over `largest` is multiplied with: the average colour of the samples, whose
  /// own luminance is `largest` (paper 003, section 4.2). 0 where all is black.
  std::array<double, 3> colour{};
};

/// @param lights  numbers of lights.
void read_field(const Btf& btf, std::size_t view, std::size_t texel,
                const std::vector<std::size_t>& lights, FieldSamples& samples);

}  // namespace weft::reflectance_fields
