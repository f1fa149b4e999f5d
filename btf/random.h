// Random numbers as a hash of their coordinates: the same whatever the threads, the order or the
// shard.
#pragma once

#include <cstdint>

namespace weft {

/// Mixes all bits of 64 (a bijection; the finaliser of splitmix64).
constexpr std::uint64_t mix_bits(std::uint64_t v) {
  v ^= v >> 30;
  v *= 0xBF58476D1CE4E5B9ULL;
  v ^= v >> 27;
  v *= 0x94D049BB133111EBULL;
  return v ^ (v >> 31);
}

/// A hash of any number of coordinates, e.g. (seed, view, texel, sample, dimension).
template <typename... Coordinates>
constexpr std::uint64_t hash_coordinates(Coordinates... coordinates) {
  std::uint64_t h = 0x9E3779B97F4A7C15ULL;
  ((h = mix_bits(h + static_cast<std::uint64_t>(coordinates) * 0xD1342543DE82EF95ULL + 1)), ...);
  return h;
}

/// The top 24 bits as a float in [0, 1): never 1.
constexpr float unit_float(std::uint64_t bits) {
  return static_cast<float>(bits >> 40) * (1.0F / 16777216.0F);
}

}  // namespace weft
