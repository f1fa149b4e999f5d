// Sixteen floats side by side (samples of a fit, kernels of a decoder), and four.
#pragma once

#include <cmath>

namespace weft::srbf {

using Vec16 = float __attribute__((vector_size(64)));
using Vec4 = float __attribute__((vector_size(16)));

template <typename Lanes>
inline Lanes load(const float* p) {
  Lanes v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
template <typename Lanes>
inline void store(float* p, const Lanes& v) {
  __builtin_memcpy(p, &v, sizeof v);
}

template <typename Lanes>
inline Lanes square_root(const Lanes& v) {
  constexpr int n = sizeof(Lanes) / sizeof(float);
  Lanes root;
  for (int i = 0; i < n; ++i) root[i] = std::sqrt(v[i]);
  return root;
}

/// e^x for x <= 0, to 2e-7 of itself; below -87 what -87 has. A NaN stays one.
template <typename Lanes>
inline Lanes exp_below_zero(Lanes x) {
  using Bits = decltype(x < x);  // whole numbers of 32 bits, as many
  x = x < -87.0F ? x - x - 87.0F : x;
  // Adding 1.5 * 2^23 rounds to the nearest whole number, which then is the low bits.
  const Lanes shifted = x * 1.44269504F + 12582912.0F;
  const Lanes whole = shifted - 12582912.0F;
  const Lanes r = (x - whole * 0.693359375F) + whole * 2.12194440e-4F;  // ln 2 in two pieces
  const Lanes p =
      1 + r * (1 + r * (0.5F + r * (1.0F / 6 + r * (1.0F / 24 + r * (1.0F / 120 + r / 720)))));
  Bits bits;
  __builtin_memcpy(&bits, &shifted, sizeof bits);
  bits = (bits << 23) + (127 << 23);
  Lanes power;
  __builtin_memcpy(&power, &bits, sizeof power);
  return p * power;
}

/// Sums a fixed tree, in double from the fourth pair on.
inline double sum_of(const Vec16& v) {
  double sum = 0;
  for (int i = 0; i < 4; ++i)
    sum += static_cast<double>((v[i] + v[i + 8]) + (v[i + 4] + v[i + 12]));
  return sum;
}
inline float sum_of(const Vec4& v) {
  return (v[0] + v[2]) + (v[1] + v[3]);
}

}  // namespace weft::srbf
