// Eight doubles side by side, for fits: their sum, exponential and logarithm.
#pragma once

#include <cstdint>
#include <cstring>

namespace weft {

using DoubleLanes = double __attribute__((vector_size(64)));
using LongLanes = std::int64_t __attribute__((vector_size(64)));

inline DoubleLanes load_lanes(const double* p) {
  DoubleLanes v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

inline double sum_of(const DoubleLanes& v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

/// e^x to 1e-12 of itself; x is held to -700 ... 700.
inline DoubleLanes exp_lanes(DoubleLanes x) {
  x = x > -700.0 ? x : DoubleLanes{} - 700.0;
  x = x < 700.0 ? x : DoubleLanes{} + 700.0;
  // Adding 1.5 * 2^52 leaves the nearest whole number in the lowest bits.
  constexpr double shift = 6755399441055744.0;
  const DoubleLanes shifted = x * 1.4426950408889634 + shift;
  const DoubleLanes whole = shifted - shift;
  const DoubleLanes r = (x - whole * 0.693147180369123816490) - whole * 1.90821492927058770002e-10;
  DoubleLanes p = DoubleLanes{} + 1.0 / 3628800;
  p = p * r + 1.0 / 362880;
  p = p * r + 1.0 / 40320;
  p = p * r + 1.0 / 5040;
  p = p * r + 1.0 / 720;
  p = p * r + 1.0 / 120;
  p = p * r + 1.0 / 24;
  p = p * r + 1.0 / 6;
  p = p * r + 0.5;
  p = p * r + 1.0;
  p = p * r + 1.0;
  return p * reinterpret_cast<DoubleLanes>((reinterpret_cast<LongLanes>(shifted) + 1023) << 52);
}

/// log x of normal x > 0, to 1e-12 of itself or of 1.
inline DoubleLanes log_lanes(const DoubleLanes& x) {
  constexpr std::int64_t root_half = 0x3FE6A09E667F3BCD;  // mantissas run from sqrt(1/2)
  const LongLanes bits = reinterpret_cast<LongLanes>(x) - root_half;
  const LongLanes exponent = bits >> 52;
  const DoubleLanes m = reinterpret_cast<DoubleLanes>((bits & 0xFFFFFFFFFFFFF) + root_half);
  const DoubleLanes s = (m - 1) / (m + 1);
  const DoubleLanes q = s * s;
  DoubleLanes p = DoubleLanes{} + 1.0 / 17;
  p = p * q + 1.0 / 15;
  p = p * q + 1.0 / 13;
  p = p * q + 1.0 / 11;
  p = p * q + 1.0 / 9;
  p = p * q + 1.0 / 7;
  p = p * q + 1.0 / 5;
  p = p * q + 1.0 / 3;
  p = p * q + 1.0;
  return __builtin_convertvector(exponent, DoubleLanes) * 0.69314718055994530942 + 2 * s * p;
}

}  // namespace weft
