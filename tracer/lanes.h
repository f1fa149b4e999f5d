// Sixteen numbers side by side: what an AVX-512 register holds. The compiler splits them on lesser
// CPUs.
#pragma once

#ifdef __AVX512DQ__
#include <immintrin.h>
#endif

#include <array>
#include <cmath>
#include <cstdint>

#include "btf/vector.h"

namespace weft {

constexpr int lanes = 16;

using FloatLanes = float __attribute__((vector_size(64)));
/// Comparisons of `FloatLanes` give these: -1 where true, 0 where not.
using IntLanes = std::int32_t __attribute__((vector_size(64)));
using WordLanes = std::uint32_t __attribute__((vector_size(64)));

struct Vec3Lanes {
  FloatLanes x, y, z;
};

struct RgbLanes {
  FloatLanes r, g, b;
};

inline FloatLanes all_lanes(float v) {
  return FloatLanes{} + v;
}

inline RgbLanes operator*(const RgbLanes& a, const Rgb& b) {
  return {a.r * b.x, a.g * b.y, a.b * b.z};
}

// The formulas that are written once for a float and for lanes use these.

inline float select(bool condition, float yes, float no) {
  return condition ? yes : no;
}
inline FloatLanes select(const IntLanes& condition, const FloatLanes& yes, const FloatLanes& no) {
  return condition ? yes : no;
}

inline float larger(float a, float b) {
  return a > b ? a : b;
}
inline FloatLanes larger(const FloatLanes& a, float b) {
  const FloatLanes all = all_lanes(b);
  return a > all ? a : all;
}
inline float smaller(float a, float b) {
  return a < b ? a : b;
}
inline FloatLanes smaller(const FloatLanes& a, float b) {
  const FloatLanes all = all_lanes(b);
  return a < all ? a : all;
}
inline FloatLanes smaller(const FloatLanes& a, const FloatLanes& b) {
  return a < b ? a : b;
}

inline float square_root(float v) {
  return std::sqrt(v);
}
inline FloatLanes square_root(const FloatLanes& v) {
  FloatLanes root;
  for (int i = 0; i < lanes; ++i) root[i] = std::sqrt(v[i]);
  return root;
}

inline FloatLanes dot(const Vec3& a, const Vec3Lanes& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline FloatLanes dot(const Vec3Lanes& a, const Vec3Lanes& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// table[index] of each lane; indices in [0, 4 * lanes). Such a table fits in registers, of which
/// lookups are cheaper than gathering from memory.
inline FloatLanes look_up(const std::array<float, std::size_t{4} * lanes>& table,
                          const IntLanes& index) {
#ifdef __AVX512DQ__
  const auto& i = reinterpret_cast<const __m512i&>(index);
  const auto quarter = [&](std::size_t n) { return _mm512_loadu_ps(table.data() + n * lanes); };
  const __m512 low = _mm512_permutex2var_ps(quarter(0), i, quarter(1));  // by five bits of i
  const __m512 high = _mm512_permutex2var_ps(quarter(2), i, quarter(3));
  return select(index < 2 * lanes, low, high);
#else
  FloatLanes values;
  for (int k = 0; k < lanes; ++k) values[k] = table[static_cast<std::size_t>(index[k])];
  return values;
#endif
}

/// Lane i true where bit i is set.
inline IntLanes lanes_of_bits(std::uint16_t bits) {
  constexpr IntLanes bit{1,   2,   4,    8,    16,   32,   64,    128,
                         256, 512, 1024, 2048, 4096, 8192, 16384, 32768};
  return ((IntLanes{} + bits) & bit) != 0;
}
/// Bit i set where lane i is true.
inline std::uint16_t bits_of_lanes(const IntLanes& condition) {
#ifdef __AVX512DQ__
  return _mm512_movepi32_mask(reinterpret_cast<const __m512i&>(condition));
#else
  unsigned bits = 0;
  for (int i = 0; i < lanes; ++i) bits |= (static_cast<unsigned>(condition[i]) & 1U) << i;
  return static_cast<std::uint16_t>(bits);
#endif
}

}  // namespace weft
