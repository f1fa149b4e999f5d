#include "codecs/srbf/kernels.h"

#include <array>
#include <cmath>

namespace weft::srbf {

std::array<double, 3> evaluate(const Kernels& kernels, const Direction& light,
                               const Direction& view) {
  const Shape& shape = kernels.shape();
  std::array<Direction, most_modes> variable;
  for (std::size_t k = 0; k < shape.modes; ++k) variable[k] = psi(kernels.angles()[k], light, view);
  std::array<double, 3> sum{};
  for (std::size_t j = 0; j < shape.kernels; ++j) {
    double exponent = 0;
    for (std::size_t k = 0; k < shape.modes; ++k) {
      const double* p = kernels.centre(j, k);
      exponent += p[0] * variable[k].x + p[1] * variable[k].y + p[2] * variable[k].z -
                  smooth_length(p[0], p[1], p[2]);
    }
    for (std::size_t c = 0; c < 3; ++c) sum[c] += kernels.colours()[3 * j + c] * std::exp(exponent);
  }
  return sum;
}

}  // namespace weft::srbf
