// Numbers of sixteen queries, loaded four at a time and written side by side.
#pragma once

#ifdef __AVX512F__

#include <array>
#include <cstddef>

#include "codecs/wide_vector.h"

namespace weft {

/// Four numbers of each of sixteen lanes, [number][lane]. Written number by number into memory,
/// they would be read again side by side before they are in the cache.
/// @param place  (lane) to where its four begin.
template <typename Place>
[[gnu::always_inline]] inline std::array<Vec16, 4> transposed(const Place& place) {
  // Lane 4 j + k begins as quarter j of row k: the four rows are transposed within quarters.
  const auto quarter = [&](std::size_t lane) {
    __m128 four;
    std::memcpy(&four, place(lane), sizeof four);
    return four;
  };
  const auto row = [&](std::size_t k) {
    __m512 quarters = _mm512_maskz_broadcast_f32x4(0x000F, quarter(k));
    quarters = _mm512_mask_broadcast_f32x4(quarters, 0x00F0, quarter(4 + k));
    quarters = _mm512_mask_broadcast_f32x4(quarters, 0x0F00, quarter(8 + k));
    return (Vec16)_mm512_mask_broadcast_f32x4(quarters, 0xF000, quarter(12 + k));
  };
  const std::array<Vec16, 4> rows{row(0), row(1), row(2), row(3)};
  const auto low = [](const Vec16& a, const Vec16& b) {
    return __builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
  };
  const auto high = [](const Vec16& a, const Vec16& b) {
    return __builtin_shufflevector(a, b, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15,
                                   31);
  };
  // 0 0' 1 1' of rows 0 and 2, of rows 1 and 3, then of those two.
  const Vec16 even = low(rows[0], rows[2]);
  const Vec16 odd = low(rows[1], rows[3]);
  const Vec16 even_high = high(rows[0], rows[2]);
  const Vec16 odd_high = high(rows[1], rows[3]);
  return {low(even, odd), high(even, odd), low(even_high, odd_high), high(even_high, odd_high)};
}

}  // namespace weft

#endif
