// What a product of parabolic maps is made of: maps a factor, index maps, a scale map, for each
// level of detail. The very arrays that the GPU gets.
//
//   B(texel, l, v) = S[texel] * prod over links of max(0, sum over terms of prod over the link's
//   factors of map(direction)) * cos(theta_l)
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "btf/vector.h"

namespace weft::factor_maps {

/// What a factor is a function of (paper 004's p_i, p_h, p_d and p_o, table 1).
enum class Projection { light, half, difference, view };

/// "light", "half", "difference" or "view".
std::string name_of(Projection projection);

/// The inverse. @throws Error  listing the names.
Projection projection_named(const std::string& name);

/// Factors of one link are multiplied term by term, and the terms added: 0 for light and view, 1
/// for half and difference.
constexpr int link_count = 2;
constexpr int link_of(Projection projection) {
  return projection == Projection::light || projection == Projection::view ? 0 : 1;
}

constexpr std::size_t max_factors = 4;
constexpr int max_terms = 8;
/// Directions are turned by multiples of 1 / 64 of a circle.
constexpr int rotation_steps = 64;

/// Values of a texture: 8 bits (a byte is byte / 255) or float; the other one is empty.
struct ValueArray {
  std::vector<std::uint8_t> bytes;
  std::vector<float> floats;

  float value(std::size_t i) const {
    return floats.empty() ? static_cast<float>(bytes[i]) * (1.0F / 255.0F) : floats[i];
  }
  std::size_t size() const { return bytes.size() + floats.size(); }
  std::size_t texture_bytes() const { return bytes.size() + floats.size() * sizeof(float); }
  bool operator==(const ValueArray&) const = default;
};

/// Rounds 0..1 to 8 bits.
std::vector<std::uint8_t> to_bytes(std::span<const float> values);

/// One factor's maps: [map][term][row][column][rgb], each a parabolic map (see `ParabolicMap`).
struct Factor {
  Projection projection = Projection::light;
  int terms = 1;  ///< the same for all factors of a link
  ValueArray maps;
};

/// One level of detail; its texels are `first` and what follows, row by row.
struct Level {
  int width = 0;
  int height = 0;
  std::size_t first = 0;
};

/// The levels of a tile: 0 is the finest, each next one half as wide and high (rounded down, at
/// least 1), as `next_mip_level` makes them.
std::vector<Level> mip_levels(int width, int height);

struct Model {
  std::string codec;            ///< name of the codec that fitted it
  std::vector<Level> levels;    ///< at least one
  int resolution = 0;           ///< texels a side of each map
  bool clustered = false;       ///< codebooks and an index map; otherwise texel i has map i
  std::vector<Factor> factors;  ///< in the order of `Projection`
  /// [texel of any level][channel]: which map of factor `channel` it uses; unused channels are 0.
  /// Empty unless clustered.
  std::vector<std::uint8_t> index;
  /// [texel of any level]: light and view are turned about the normal by minus this many
  /// `rotation_steps` before they are looked up. Empty where none is turned.
  std::vector<std::uint8_t> rotation;
  /// S, [texel of any level][rgb], 0..1. In 8 bits its square root: on glossy data S differs by
  /// thousands from texel to texel, and equal steps would leave the dull texels none.
  ValueArray scale;
  Rgb scale_max = Rgb(0, 0, 0);  ///< what 1 in S stands for, 1/sr
  HemisphereSampling views;
  HemisphereSampling lights;
  std::string parameters = "{}";  ///< JSON: every parameter of the fit, defaults too
  std::string provenance = "{}";  ///< JSON: the data's

  int width() const { return levels[0].width; }
  int height() const { return levels[0].height; }
  /// Of all levels.
  std::size_t texels() const {
    const Level& last = levels.back();
    return last.first + static_cast<std::size_t>(last.width) * last.height;
  }
  /// Of one term.
  std::size_t values_a_map() const { return 3 * static_cast<std::size_t>(resolution) * resolution; }
  std::size_t map_count(std::size_t factor) const {
    return factors[factor].maps.size() / (values_a_map() * factors[factor].terms);
  }
  /// Channels of `index`: three a texture.
  std::size_t index_channels() const { return factors.size() > 3 ? 6 : 3; }
  /// S of a texel, 1/sr.
  Rgb scale_of(std::size_t texel) const {
    const Rgb stored(scale.value(3 * texel), scale.value(3 * texel + 1),
                     scale.value(3 * texel + 2));
    return scale_max * (scale.floats.empty() ? stored * stored : stored);
  }
  std::size_t map_of(std::size_t factor, std::size_t texel) const {
    return clustered ? index[index_channels() * texel + factor] : texel;
  }
};

}  // namespace weft::factor_maps
