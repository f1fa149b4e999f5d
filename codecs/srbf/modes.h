// The variables of the kernels: psi_k = a_k light + b_k view (paper 001, equation 3.7), normalised.
//
// The paper leaves a and b free; after normalising only the angle between them matters:
// a = cos(t), b = sin(t). So one number a mode: 0 the light, 45 degrees the half-way vector, 90 the
// view, -45 the difference.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "btf/direction.h"

namespace weft::srbf {

constexpr std::size_t most_modes = 4;

/// Keeps psi finite where light and view cancel.
constexpr float smallest_square = 1e-8F;

/// Squared radius within which |p| is rounded off, so that it has a derivative at 0.
constexpr float rounding_square = 1e-6F;

/// |p| = lambda of a centre p = lambda xi.
inline double smooth_length(double x, double y, double z) {
  return std::sqrt(x * x + y * y + z * z + rounding_square);
}

/// psi of a mode of angle t. @param light, view  unit vectors.
inline Direction psi(double angle, const Direction& light, const Direction& view) {
  const Direction sum =
      light * static_cast<float>(std::cos(angle)) + view * static_cast<float>(std::sin(angle));
  return sum / std::sqrt((sum ^ sum) + smallest_square);
}

/// Which modes a fit begins with, and whether their angles are optimised.
struct Modes {
  std::string name;
  std::vector<double> angles;
  bool free = false;
  bool multivariate = true;
  bool em_angles = false;  ///< the initial guess moves them, too (equation 3.11)
};

/// `modes`: optimal | half-half-half | half-difference | half-light-view | in-out; `multivariate =
/// false` keeps the first mode alone (the univariate SRBF).
/// @param count  modes of `optimal`, 1 to 4.
Modes modes_named(const std::string& name, std::size_t count, bool multivariate);
std::vector<std::string> mode_names();

}  // namespace weft::srbf
