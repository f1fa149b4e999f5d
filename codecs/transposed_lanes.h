// Four numbers of each of several things that lie side by side, as four vectors of one number of
// all.
#pragma once

#include <array>
#include <cstddef>

#include "codecs/wide_vector.h"

namespace weft {

/// a0 b0 a1 b1 of each quad.
inline Wide low_pairs(const Wide& a, const Wide& b) {
#ifdef __AVX512F__
  return __builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
#else
  return __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
#endif
}

/// a2 b2 a3 b3 of each quad.
inline Wide high_pairs(const Wide& a, const Wide& b) {
#ifdef __AVX512F__
  return __builtin_shufflevector(a, b, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
#else
  return __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
#endif
}

/// Vector i of the result has in each quad number i of that quad of the four rows.
[[gnu::always_inline]] inline std::array<Wide, 4> transposed(const std::array<Wide, 4>& row) {
  const Wide even = low_pairs(row[0], row[2]);
  const Wide odd = low_pairs(row[1], row[3]);
  const Wide even_high = high_pairs(row[0], row[2]);
  const Wide odd_high = high_pairs(row[1], row[3]);
  return {low_pairs(even, odd), high_pairs(even, odd), low_pairs(even_high, odd_high),
          high_pairs(even_high, odd_high)};
}

#ifdef __AVX512F__
/// Four numbers of each of sixteen lanes, [number][lane]. Written number by number into memory,
/// they would be read again side by side before they are in the cache.
/// @param place  (lane) to where its four begin.
template <typename Place>
[[gnu::always_inline]] inline std::array<Vec16, 4> lanes_at(const Place& place) {
  // Lane 4 j + k begins as quad j of row k: rows are transposed within quads.
  const auto row = [&](std::size_t k) {
    return quads_at(std::array{place(k), place(4 + k), place(8 + k), place(12 + k)});
  };
  return transposed({row(0), row(1), row(2), row(3)});
}
#endif

}  // namespace weft
