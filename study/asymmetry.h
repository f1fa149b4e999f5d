// How much energy each light field and each reflectance field of a texel holds (paper 003, section
// 4.1 and figure 3). A reciprocal BRDF has the same in both; depth makes reflectance fields jump
// from view to view.
#pragma once

#include <span>
#include <vector>

#include "btf/btf.h"

namespace weft {

/// Sums of the luminance (Rec. 709) of f = B / cos(theta_light), in 1/sr. Lights on the horizon,
/// which tell nothing about f, have energy 0.
struct FieldEnergies {
  std::vector<double> light_fields;        ///< [light]: over all views, the paper's E_i
  std::vector<double> reflectance_fields;  ///< [view]: over all lights, the paper's E_r
};

/// Of one texel.
FieldEnergies field_energies(const Btf& btf, int x, int y);

/// How rough a series over a sampling's directions is: the mean difference between neighbours,
/// those that share a triangle, over the series' mean. 0 where it is constant, or has no
/// neighbours.
double roughness(const HemisphereSampling& sampling, std::span<const double> series);

/// Mean of |E_r - E_i| over their mean: 0 for a reciprocal BRDF. 0 where the samplings differ.
double asymmetry(const Btf& btf, const FieldEnergies& energies);

}  // namespace weft
