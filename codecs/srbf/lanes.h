// As many floats side by side as the CPU has (samples of a fit, kernels of a decoder).
#pragma once

#include <cmath>

#include "codecs/wide_vector.h"

namespace weft::srbf {

template <typename Lanes>
inline void store(float* p, const Lanes& v) {
  std::memcpy(p, &v, sizeof v);
}

template <typename Lanes>
inline Lanes square_root(const Lanes& v) {
  constexpr int n = sizeof(Lanes) / sizeof(float);
  Lanes root;
  for (int i = 0; i < n; ++i) root[i] = std::sqrt(v[i]);
  return root;
}

/// e^x for x <= 0, to 3e-7 of itself; below -87 what -87 has. A NaN stays one.
template <typename Lanes>
inline Lanes exp_below_zero(Lanes x) {
  using Bits = decltype(x < x);  // whole numbers of 32 bits, as many
  x = x < -87.0F ? Lanes{} - 87.0F : x;
  // Adding 1.5 * 2^23 rounds to the nearest whole number, which then is the low bits.
  const Lanes shifted = x * 1.44269504F + 12582912.0F;
  const Lanes whole = shifted - 12582912.0F;
  const Lanes r = (x - whole * 0.693359375F) + whole * 2.12194440e-4F;  // ln 2 in two pieces
  const Lanes p =
      1 +
      r * (1 + r * (0.5F + r * (1.0F / 6 + r * (1.0F / 24 + r * (1.0F / 120 + r * (1.0F / 720))))));
  Bits bits;
  std::memcpy(&bits, &shifted, sizeof bits);
  bits = (bits << 23) + (127 << 23);
  Lanes power;
  std::memcpy(&power, &bits, sizeof power);
  return p * power;
}

/// The lanes' sum, in double and in a fixed order.
inline double sum_in_double(const Wide& v) {
  double sum = 0;
  for (std::size_t i = 0; i < wide_lanes / 2; ++i)
    sum += static_cast<double>(v[i]) + static_cast<double>(v[i + wide_lanes / 2]);
  return sum;
}

}  // namespace weft::srbf
