// Maps of bytes laid out for bilinear lookups: what one lookup needs is sixteen bytes side by side.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "codecs/factor_maps/map_lookup.h"
#include "codecs/stencil_batch.h"
#include "codecs/transposed_lanes.h"
#include "codecs/wide_vector.h"

namespace weft::factor_maps {

/// r g b 0 of a map's texel, and of the one below it.
struct TexelPair {
  std::array<std::uint8_t, 4> upper;
  std::array<std::uint8_t, 4> lower;
};

/// @param maps  [map][row][column][rgb].
/// @return      [map][row][column], without the last rows, which have none below.
std::vector<TexelPair> texel_pairs(std::span<const std::uint8_t> maps, int resolution);

constexpr std::size_t pairs_a_map(int resolution) {
  return static_cast<std::size_t>(resolution) * (resolution - 1);
}

/// The twins of those for rows.
[[gnu::always_inline]] inline Vec4 looked_up(const TexelPair* map, std::size_t /*row_values*/,
                                             const MapPlace& place) {
  Byte16 bytes;
  std::memcpy(&bytes, map + place.first, sizeof bytes);
  const Vec16 values = floats_of(bytes);
  const Vec8 left = low_half(values);
  const Vec8 column = left + place.across * (high_half(values) - left);
  const Vec4 upper = __builtin_shufflevector(column, column, 0, 1, 2, 3);
  const Vec4 lower = __builtin_shufflevector(column, column, 4, 5, 6, 7);
  return upper + place.down * (lower - upper);
}
[[gnu::always_inline]] inline Vec4 looked_up(const TexelPair* map, std::size_t row_values,
                                             const MapPlace& place, const Vec16& /*weight*/) {
  return looked_up(map, row_values, place);
}

#ifdef __AVX512F__
struct RgbLanes {
  Vec16 r;
  Vec16 g;
  Vec16 b;

  RgbLanes& operator*=(const RgbLanes& o) {
    r *= o.r;
    g *= o.g;
    b *= o.b;
    return *this;
  }
  RgbLanes& operator+=(const RgbLanes& o) {
    r += o.r;
    g += o.g;
    b += o.b;
    return *this;
  }
  friend RgbLanes operator*(const RgbLanes& v, const Vec16& s) {
    return {v.r * s, v.g * s, v.b * s};
  }
};

/// Sixteen lookups.
/// @param first  of `pairs`, each lane's left column.
[[gnu::always_inline]] inline RgbLanes looked_up(const TexelPair* pairs,
                                                 const Batch<std::uint32_t>& first,
                                                 const Vec16& across, const Vec16& down) {
  using UInt16 = std::uint32_t __attribute__((vector_size(64)));
  using Int16 = std::int32_t __attribute__((vector_size(64)));
  const std::array<Vec16, 4> texels =
      lanes_at([&](std::size_t lane) { return pairs + first[lane]; });
  const auto blended = [&](const auto& channel_of) {
    const auto channel = [&](std::size_t corner) {
      return __builtin_convertvector((Int16)channel_of((UInt16)texels[corner]), Vec16);
    };
    const Vec16 upper = channel(0) + across * (channel(2) - channel(0));
    const Vec16 lower = channel(1) + across * (channel(3) - channel(1));
    return upper + down * (lower - upper);
  };
  return {blended([](const UInt16& texel) { return texel & 0xFF; }),
          blended([](const UInt16& texel) { return texel >> 8 & 0xFF; }),
          blended([](const UInt16& texel) { return texel >> 16; })};
}
#endif

}  // namespace weft::factor_maps
