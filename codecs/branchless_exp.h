// Exponential and logarithm without branches, so that a loop over them is vectorised; the standard
// library's are called one by one.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace weft {

/// e^x to 2e-7 of itself; x is clamped to -87 ... 88, what a float holds.
inline float branchless_exp(float x) {
  const float t = std::clamp(x, -87.0F, 88.0F) * 1.44269504F;
  const float whole = std::floor(t + 0.5F);
  const float r = (t - whole) * 0.693147181F;
  const float p =
      1 + r * (1 + r * (0.5F + r * (1.0F / 6 + r * (1.0F / 24 + r * (1.0F / 120 + r / 720)))));
  return p * std::bit_cast<float>((static_cast<std::int32_t>(whole) + 127) << 23);
}

/// log x of a normal x > 0, to 2e-7 of itself or 1e-7 near 1.
inline float branchless_log(float x) {
  constexpr std::int32_t root_half = 0x3F3504F3;  // mantissas run from sqrt(1/2) to sqrt(2)
  const std::int32_t bits = std::bit_cast<std::int32_t>(x) - root_half;
  const auto exponent = static_cast<float>(bits >> 23);
  const float m = std::bit_cast<float>((bits & 0x7FFFFF) + root_half);
  const float s = (m - 1) / (m + 1);
  const float q = s * s;
  return exponent * 0.693147181F +
         2 * s * (1 + q * (1.0F / 3 + q * (1.0F / 5 + q * (1.0F / 7 + q / 9))));
}

}  // namespace weft
