// Four, eight and sixteen floats side by side. GCC 12 keeps vectors wider than the CPU's in memory,
// element by element; two halves are as fast as they should be.
#pragma once

#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace weft {

using Vec4 = float __attribute__((vector_size(16)));
using Vec8 = float __attribute__((vector_size(32)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

#ifdef __AVX512F__
using Vec16 = float __attribute__((vector_size(64)));
#else
struct Vec16 {
  Vec8 low;
  Vec8 high;

  friend Vec16 operator+(const Vec16& a, const Vec16& b) {
    return {a.low + b.low, a.high + b.high};
  }
  friend Vec16 operator-(const Vec16& a, const Vec16& b) {
    return {a.low - b.low, a.high - b.high};
  }
  friend Vec16 operator*(const Vec16& a, const Vec16& b) {
    return {a.low * b.low, a.high * b.high};
  }
  friend Vec16 operator-(const Vec16& a, float b) { return {a.low - b, a.high - b}; }
  friend Vec16 operator*(const Vec16& a, float b) { return {a.low * b, a.high * b}; }
  friend Vec16 operator*(float a, const Vec16& b) { return b * a; }
  Vec16& operator+=(const Vec16& b) { return *this = *this + b; }
};
#endif

template <typename Lanes>
inline Lanes load(const float* p) {
  Lanes v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

#ifdef __AVX512F__
inline Vec8 low_half(const Vec16& v) {
  return __builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7);
}
inline Vec8 high_half(const Vec16& v) {
  return __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15);
}
#else
template <>
inline Vec16 load(const float* p) {
  return {load<Vec8>(p), load<Vec8>(p + 8)};
}
inline Vec8 low_half(const Vec16& v) {
  return v.low;
}
inline Vec8 high_half(const Vec16& v) {
  return v.high;
}
#endif

inline void add_to(float* p, const Vec4& v) {
  const Vec4 sum = load<Vec4>(p) + v;
  std::memcpy(p, &sum, sizeof sum);
}
inline void add_to(float* p, const Vec16& v) {
  const Vec16 sum = load<Vec16>(p) + v;
  const Vec8 low = low_half(sum);
  const Vec8 high = high_half(sum);
  std::memcpy(p, &low, sizeof low);
  std::memcpy(p + 8, &high, sizeof high);
}

inline Vec8 joined(const Vec4& a, const Vec4& b) {
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}
inline Vec16 joined(const Vec8& a, const Vec8& b) {
#ifdef __AVX512F__
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#else
  return {a, b};
#endif
}

/// As many floats side by side as the CPU has, and how many quads of them.
#ifdef __AVX512F__
using Wide = Vec16;
#else
using Wide = Vec8;
#endif
constexpr std::size_t wide_lanes = sizeof(Wide) / sizeof(float);
using WideInt = std::int32_t __attribute__((vector_size(sizeof(Wide))));
using WideUnsigned = std::uint32_t __attribute__((vector_size(sizeof(Wide))));
constexpr std::size_t wide_quads = wide_lanes / 4;

/// Quads from several places, loaded straight to where they belong.
template <typename Value>
[[gnu::always_inline]] inline Wide quads_at(const std::array<const Value*, wide_quads>& place) {
  const auto quad = [](const Value* p) {
    Vec4 v;
    std::memcpy(&v, p, sizeof v);
    return v;
  };
#ifdef __AVX512F__
  __m512 v = _mm512_maskz_broadcast_f32x4(0x000F, (__m128)quad(place[0]));
  v = _mm512_mask_broadcast_f32x4(v, 0x00F0, (__m128)quad(place[1]));
  v = _mm512_mask_broadcast_f32x4(v, 0x0F00, (__m128)quad(place[2]));
  return (Wide)_mm512_mask_broadcast_f32x4(v, 0xF000, (__m128)quad(place[3]));
#else
  return joined(quad(place[0]), quad(place[1]));
#endif
}

/// Number k of each quad, four times.
template <int k>
inline Wide of_each_quad(const Wide& v) {
#ifdef __AVX512F__
  return __builtin_shufflevector(v, v, k, k, k, k, 4 + k, 4 + k, 4 + k, 4 + k, 8 + k, 8 + k, 8 + k,
                                 8 + k, 12 + k, 12 + k, 12 + k, 12 + k);
#else
  return __builtin_shufflevector(v, v, k, k, k, k, 4 + k, 4 + k, 4 + k, 4 + k);
#endif
}

inline float sum_of(const Vec4& v) {
  return (v[0] + v[2]) + (v[1] + v[3]);
}
inline float sum_of(const Vec8& v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}
inline float sum_of(const Vec16& v) {
  return sum_of(low_half(v) + high_half(v));
}

/// 0 where v is below 0 or a NaN.
inline Vec4 not_negative(Vec4 v) {
  for (std::size_t i = 0; i < 4; ++i) v[i] = std::max(0.0F, v[i]);
  return v;
}
inline Vec16 not_negative(const Vec16& v) {
#ifdef __AVX512F__
  return v > 0 ? v : Vec16{};
#else
  return {v.low > 0 ? v.low : Vec8{}, v.high > 0 ? v.high : Vec8{}};
#endif
}

/// Four numbers, four times.
inline Vec16 four_times(const float* p) {
  const Vec4 quad = load<Vec4>(p);
#ifdef __AVX512F__
  // Unmasked, GCC 12 takes its own header for uninitialised (its bug 105593).
  return (Vec16)_mm512_maskz_broadcast_f32x4(0xFFFF, (__m128)quad);
#else
  const Vec8 twice = joined(quad, quad);
  return {twice, twice};
#endif
}

/// In each quarter: p0 + p1, p2 + p3, q0 + q1, q2 + q3.
inline Vec16 pairwise_sums(const Vec16& p, const Vec16& q) {
#ifdef __AVX512F__
  using Int16 = std::int32_t __attribute__((vector_size(64)));
  return __builtin_shuffle(p, q, Int16{0, 2, 16, 18, 4, 6, 20, 22, 8, 10, 24, 26, 12, 14, 28, 30}) +
         __builtin_shuffle(p, q, Int16{1, 3, 17, 19, 5, 7, 21, 23, 9, 11, 25, 27, 13, 15, 29, 31});
#else
  using Int8 = std::int32_t __attribute__((vector_size(32)));
  const auto half = [](const Vec8& a, const Vec8& b) {
    return __builtin_shuffle(a, b, Int8{0, 2, 8, 10, 4, 6, 12, 14}) +
           __builtin_shuffle(a, b, Int8{1, 3, 9, 11, 5, 7, 13, 15});
  };
  return {half(p.low, q.low), half(p.high, q.high)};
#endif
}

}  // namespace weft
