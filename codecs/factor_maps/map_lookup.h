// Bilinear lookups of three channels in a map. Two by two neighbouring texels are one vector of
// sixteen floats: r g b r g b and two unused values of the upper row, two unused ones and
// r g b r g b of the lower one.
#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "codecs/factor_maps/map_places.h"
#include "codecs/wide_vector.h"

namespace weft::factor_maps {

using Byte16 = std::uint8_t __attribute__((vector_size(16)));

// The compiler's own conversion of vectors takes bytes apart in many steps: half of the decoder's
// time.
inline Vec16 floats_of(const Byte16& bytes) {
#ifdef __AVX512F__
  // Unmasked, GCC 12 takes its own header for uninitialised (its bug 105593).
  using Int16 = std::int32_t __attribute__((vector_size(64)));
  return __builtin_convertvector((Int16)_mm512_maskz_cvtepu8_epi32(0xFFFF, (__m128i)bytes), Vec16);
#elif defined(__AVX2__)
  const auto b = (__m128i)bytes;
  return {(Vec8)_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(b)),
          (Vec8)_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_unpackhi_epi64(b, b)))};
#else
  using Byte8 = std::uint8_t __attribute__((vector_size(8)));
  using Int8 = std::int32_t __attribute__((vector_size(32)));
  std::array<Byte8, 2> halves;
  std::memcpy(&halves, &bytes, sizeof halves);
  const auto wide = [](const Byte8& half) {
    return __builtin_convertvector(__builtin_convertvector(half, Int8), Vec8);
  };
  return {wide(halves[0]), wide(halves[1])};
#endif
}

/// Eight values from `row` on, of which six count, and eight that end with the six of the row
/// below: that way neither reads beyond the map.
inline Vec16 two_rows(const std::uint8_t* row, std::size_t row_values) {
  std::array<std::uint64_t, 2> rows;
  std::memcpy(&rows[0], row, 8);
  std::memcpy(&rows[1], row + row_values - 2, 8);
  Byte16 bytes;
  std::memcpy(&bytes, &rows, sizeof bytes);
  return floats_of(bytes);
}
inline Vec16 two_rows(const float* row, std::size_t row_values) {
  return joined(load<Vec8>(row), load<Vec8>(row + row_values - 2));
}

/// One lookup.
/// @param map  its first value.
template <typename Value>
[[gnu::always_inline]] inline Vec4 looked_up(const Value* map, std::size_t row_values,
                                             const MapPlace& place) {
  const float across = place.across;
  const float down = place.down;
  const Vec16 rows = two_rows(map + 3 * static_cast<std::size_t>(place.first), row_values);
#ifdef __AVX512F__
  const Vec16 right =
      __builtin_shufflevector(rows, rows, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2);
  const Vec16 mixed = rows + across * (right - rows);
  const Vec4 upper = __builtin_shufflevector(mixed, mixed, 0, 1, 2, 3);
  const Vec4 lower = __builtin_shufflevector(mixed, mixed, 10, 11, 12, 13);
#else
  const auto left_texel = [&](const Vec8& row) {
    const Vec8 right = __builtin_shufflevector(row, row, 3, 4, 5, 6, 7, 0, 1, 2);
    return row + across * (right - row);
  };
  const Vec8 upper_row = left_texel(rows.low);
  const Vec8 lower_row = left_texel(rows.high);
  const Vec4 upper = __builtin_shufflevector(upper_row, upper_row, 0, 1, 2, 3);
  const Vec4 lower = __builtin_shufflevector(lower_row, lower_row, 2, 3, 4, 5);
#endif
  return upper + down * (lower - upper);
}

alignas(64) inline constexpr std::array<float, 16> left_weight{1, 1, 1, 0, 0, 0, 0, 0,
                                                               0, 0, 1, 1, 1, 0, 0, 0};
alignas(64) inline constexpr std::array<float, 16> right_minus_left{-1, -1, -1, 1,  1,  1, 0, 0,
                                                                    0,  0,  -1, -1, -1, 1, 1, 1};
alignas(64) inline constexpr std::array<float, 16> upper_weight{1, 1, 1, 1, 1, 1, 1, 1,
                                                                0, 0, 0, 0, 0, 0, 0, 0};
alignas(64) inline constexpr std::array<float, 16> lower_minus_upper{-1, -1, -1, -1, -1, -1, -1, -1,
                                                                     1,  1,  1,  1,  1,  1,  1,  1};

inline Vec4 low(const Vec8& v) {
  return __builtin_shufflevector(v, v, 0, 1, 2, 3);
}

/// What weighs the values of `two_rows`, for lookups in several maps at one place.
inline Vec16 blend_weights(float across, float down) {
  return (load<Vec16>(left_weight.data()) + across * load<Vec16>(right_minus_left.data())) *
         (load<Vec16>(upper_weight.data()) + down * load<Vec16>(lower_minus_upper.data()));
}

// r g b: of each the two in the upper row, from 0 on, and the two in the lower row, from 10 on.
inline Vec4 folded(const Vec16& v) {
#ifdef __AVX512F__
  using Int16 = std::int32_t __attribute__((vector_size(64)));
  const Vec8 rows = low_half(
      v + __builtin_shuffle(v, Int16{10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
#else
  const Vec8 rows = v.low + __builtin_shufflevector(v.high, v.high, 2, 3, 4, 5, 6, 7, 0, 1);
#endif
  return low(rows + __builtin_shufflevector(rows, rows, 3, 4, 5, 6, 7, 0, 1, 2));
}

/// @param weight  `blend_weights` of the place.
template <typename Value>
[[gnu::always_inline]] inline Vec4 looked_up(const Value* map, std::size_t row_values,
                                             const MapPlace& place, const Vec16& weight) {
  return folded(two_rows(map + 3 * static_cast<std::size_t>(place.first), row_values) * weight);
}

}  // namespace weft::factor_maps
