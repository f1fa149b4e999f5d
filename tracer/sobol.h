// Owen-scrambled Sobol points in two dimensions, each pair of dimensions shuffled and scrambled by
// a hash.
//
// Burley, "Practical hash-based Owen scrambling", JCGT 9(4), 2020, with Vegdahl's constants for the
// hash.
#pragma once

#include <array>
#include <cstdint>

#include "btf/random.h"

namespace weft {

// Words are std::uint32_t, or vectors of these.

template <typename Words>
constexpr Words reverse_bits(Words x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0F0F0F0FU) | ((x & 0x0F0F0F0FU) << 4);
  x = ((x >> 8) & 0x00FF00FFU) | ((x & 0x00FF00FFU) << 8);
  return x >> 16 | x << 16;
}

/// A random permutation of [0, 1) in base 2 that keeps every elementary interval; of numbers whose
/// bits are in reverse.
template <typename Words>
constexpr Words owen_scramble_reversed(Words x, std::uint32_t seed) {
  x ^= x * 0x3D20ADEAU;
  x += seed;
  x *= (seed >> 16) | 1U;
  x ^= x * 0x05526C56U;
  x ^= x * 0x53A22864U;
  return x;
}

/// Second dimension of Sobol's sequence, its bits in reverse (the first dimension's are the index).
/// With the index as a polynomial p(s) over bits, these are p(1 + s): halves are folded at every
/// power of two.
template <typename Words>
constexpr Words sobol_second_reversed(Words index) {
  index ^= (index >> 1) & 0x55555555U;
  index ^= (index >> 2) & 0x33333333U;
  index ^= (index >> 4) & 0x0F0F0F0FU;
  index ^= (index >> 8) & 0x00FF00FFU;
  index ^= (index >> 16) & 0x0000FFFFU;
  return index;
}

/// Point `index` of the (0, 2)-sequence that `key` (a hash of all other coordinates) names, in
/// units of 2^-32.
template <typename Words>
constexpr std::array<Words, 2> sobol_words(Words index, std::uint64_t key) {
  const auto low = static_cast<std::uint32_t>(key);
  const auto high = static_cast<std::uint32_t>(key >> 32);
  const Words shuffled = reverse_bits(owen_scramble_reversed(reverse_bits(index), low));
  return {reverse_bits(owen_scramble_reversed(shuffled, high)),
          reverse_bits(owen_scramble_reversed(sobol_second_reversed(shuffled),
                                              static_cast<std::uint32_t>(mix_bits(key))))};
}

/// The same, each in [0, 1).
constexpr std::array<float, 2> sobol_point(std::uint32_t index, std::uint64_t key) {
  const auto [x, y] = sobol_words(index, key);
  return {static_cast<float>(x >> 8) * (1.0F / 16777216.0F),
          static_cast<float>(y >> 8) * (1.0F / 16777216.0F)};
}

}  // namespace weft
