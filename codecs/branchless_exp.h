// Exponential and logarithm without branches, so that a loop over them is vectorised; the standard
// library's are called one by one.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace weft {

/// e^x to 3e-7 of itself; x is clamped to -87 ... 88, what a float holds.
inline float branchless_exp(float x) {
  x = std::clamp(x, -87.0F, 88.0F);
  const float whole = std::floor(x * 1.44269504F + 0.5F);
  // log 2 in two parts, of which the first times `whole` is exact.
  const float r = (x - whole * 0.693359375F) + whole * 2.12194440e-4F;
  const float q = r * r;  // powers in pairs: half the chain of products that wait for each other
  const float p =
      1 + r + q * (0.5F + r * (1.0F / 6) + q * (1.0F / 24 + r * (1.0F / 120) + q * (1.0F / 720)));
  return p * std::bit_cast<float>((static_cast<std::int32_t>(whole) + 127) << 23);
}

/// log x of a normal x > 0, to 1.5e-7 of itself, or of 1 where that is more. Without a division,
/// which would take as long as all the rest (coefficients of Cephes' logf).
inline float branchless_log(float x) {
  constexpr std::int32_t root_half = 0x3F3504F3;  // mantissas run from sqrt(1/2) to sqrt(2)
  const std::int32_t bits = std::bit_cast<std::int32_t>(x) - root_half;
  const auto exponent = static_cast<float>(bits >> 23);
  const float m = std::bit_cast<float>((bits & 0x7FFFFF) + root_half) - 1;
  const float q = m * m;
  const float low =
      3.3333331174e-1F - 2.4999993993e-1F * m + q * (2.0000714765e-1F - 1.6668057665e-1F * m);
  const float high = 1.4249322787e-1F - 1.2420140846e-1F * m +
                     q * (1.1676998740e-1F - 1.1514610310e-1F * m + q * 7.0376836292e-2F);
  const float p = low + q * q * high;
  return exponent * 0.693147181F + (m + q * (p * m - 0.5F));
}

/// x[k]^n[k] of x in [0, 1] (or a bit more) and n >= 0, to 4e-7 (1 + |log x^n|) of itself; held at
/// 2^-125. By minimax polynomials of base 2: fewer steps than an exponential of a logarithm. Of
/// floats, or vectors of them, step by step for all k: one after the other, a power would wait in
/// the CPU's queue for the one before.
/// @tparam Int, Unsigned  as many integers.
template <typename Int, typename Unsigned, typename F, std::size_t Count>
[[gnu::always_inline]] inline std::array<F, Count> branchless_powers(
    const std::array<F, Count>& x, const std::array<F, Count>& n) {
  constexpr std::int32_t root_half = 0x3F3504F3;
  const auto as_float = [](const Int& v) {
    if constexpr (std::is_arithmetic_v<Int>) {
      return static_cast<F>(v);
    } else {
      return __builtin_convertvector(v, F);
    }
  };
  const auto each = [](const auto& step) {
    for (std::size_t k = 0; k < Count; ++k) step(k);
  };
  std::array<Int, Count> bits;
  std::array<F, Count> m, q, low, high, y, shifted, r, power;  // NOLINT
  each([&](std::size_t k) { bits[k] = std::bit_cast<Int>(x[k]) - root_half; });
  each([&](std::size_t k) {
    m[k] = std::bit_cast<F>((bits[k] & 0x7FFFFF) + root_half) - 1.0F;
    q[k] = m[k] * m[k];
  });
  each([&](std::size_t k) {
    low[k] = (1.4426949F - 0.721352816F * m[k]) + q[k] * (0.480923235F - 0.360239625F * m[k]);
    high[k] = (0.287098706F - 0.24887687F * m[k]) + q[k] * (0.234042361F - 0.145811677F * m[k]);
  });
  each([&](std::size_t k) {
    y[k] = n[k] * (as_float(bits[k] >> 23) + m[k] * (low[k] + q[k] * q[k] * high[k]));
    y[k] = y[k] < -125.0F ? F{} - 125.0F : y[k];
  });
  // Adding 1.5 * 2^23 leaves the nearest whole number in the lowest bits.
  constexpr float shift = 12582912;
  each([&](std::size_t k) {
    shifted[k] = y[k] + shift;
    r[k] = y[k] - (shifted[k] - shift);
    q[k] = r[k] * r[k];
  });
  each([&](std::size_t k) {
    power[k] = (1.00000012F + 0.693146944F * r[k]) + q[k] * (0.240221202F + 0.0555071309F * r[k]) +
               q[k] * q[k] * (0.00967554096F + 0.00132764713F * r[k]);
  });
  each([&](std::size_t k) {
    // Unsigned, as what is beyond a float's range wraps around.
    power[k] = std::bit_cast<F>(std::bit_cast<Unsigned>(power[k]) +
                                (std::bit_cast<Unsigned>(shifted[k]) << 23));
  });
  return power;
}

/// The same of one.
inline float branchless_power(float x, float n) {
  return branchless_powers<std::int32_t, std::uint32_t>(std::array{x}, std::array{n})[0];
}

}  // namespace weft
