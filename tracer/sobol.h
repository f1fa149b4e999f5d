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

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0F0F0F0FU) | ((x & 0x0F0F0F0FU) << 4);
  return __builtin_bswap32(x);
}

/// A random permutation of [0, 1) in base 2 that keeps every elementary interval; of numbers whose
/// bits are in reverse.
constexpr std::uint32_t owen_scramble_reversed(std::uint32_t x, std::uint32_t seed) {
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
constexpr std::uint32_t sobol_second_reversed(std::uint32_t index) {
  index ^= (index >> 1) & 0x55555555U;
  index ^= (index >> 2) & 0x33333333U;
  index ^= (index >> 4) & 0x0F0F0F0FU;
  index ^= (index >> 8) & 0x00FF00FFU;
  index ^= (index >> 16) & 0x0000FFFFU;
  return index;
}

/// Point `index` of the (0, 2)-sequence that `key` (a hash of all other coordinates) names; each in
/// [0, 1).
constexpr std::array<float, 2> sobol_point(std::uint32_t index, std::uint64_t key) {
  const auto low = static_cast<std::uint32_t>(key);
  const auto high = static_cast<std::uint32_t>(key >> 32);
  const std::uint32_t shuffled = reverse_bits(owen_scramble_reversed(reverse_bits(index), low));
  const std::uint32_t x = reverse_bits(owen_scramble_reversed(shuffled, high));
  const std::uint32_t y = reverse_bits(owen_scramble_reversed(
      sobol_second_reversed(shuffled), static_cast<std::uint32_t>(mix_bits(key))));
  return {static_cast<float>(x >> 8) * (1.0F / 16777216.0F),
          static_cast<float>(y >> 8) * (1.0F / 16777216.0F)};
}

}  // namespace weft
