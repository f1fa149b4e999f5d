// Where the fit of a reflectance field starts: a sum of lobes has many valleys.
#pragma once

#include <span>
#include <vector>

#include "codecs/lobes/lobe_fit.h"

namespace weft::lobes {

/// How far each sample stands out from the mean of its neighbours: a high-pass filter over the
/// sphere (paper 003, section 4.2). `size()` values.
std::vector<double> high_pass(const LightTable& lights, std::span<const double> values);

/// Lights whose high-pass is positive and no neighbour's is larger, the largest first: the paper's
/// principal directions. At most `count`.
std::vector<std::size_t> principal_lights(const LightTable& lights, std::span<const double> values,
                                          std::size_t count);

/// c cos(theta_light), the least squares one: what remains where every fit fails.
LobeSum cosine_lobe(const LightTable& lights, std::span<const double> values, int count);

/// One lobe along the values' mean direction.
LobeSum mean_lobe(const LightTable& lights, std::span<const double> values);

/// Starts for `count` lobes: at the principal directions; one along the mean and the rest at
/// principal directions; and what one lobe leaves, lobe by lobe. Peaks are the best for the axes
/// and exponents.
/// @param limits  for the lobes that are fitted one by one.
std::vector<LobeSum> starts(const LightTable& lights, std::span<const double> values, int count,
                            const FitLimits& limits);

}  // namespace weft::lobes
