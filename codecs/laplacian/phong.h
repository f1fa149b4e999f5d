// The shading model that stands for the mean of the pyramid's top (paper 000, equation 5).
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "btf/hemisphere_sampling.h"

namespace weft::laplacian {

/// mu'(light, view) = ka + kd (N.L) + ks (N.H)^alpha, N = (0, 0, 1); all four >= 0.
struct Phong {
  float ka = 0;
  float kd = 0;
  float ks = 0;
  float alpha = 1;

  float operator()(const Direction& light, const Direction& view) const {
    float value = ka + kd * light.z;
    if (ks > 0) {
      const Direction sum = light + view;
      const float cosine = sum.z / std::sqrt(sum ^ sum);
      value += ks * std::pow(cosine, alpha);
    }
    return value;
  }
  bool operator==(const Phong&) const = default;
};

/// Least squares over all pairs above the horizon, by Levenberg and Marquardt.
/// @param values  [view][light].
Phong fit_phong(const HemisphereSampling& views, const HemisphereSampling& lights,
                const std::vector<double>& values);

}  // namespace weft::laplacian
