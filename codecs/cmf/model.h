// What a fitted CMF is made of: a codebook of maps a factor, index maps, a scale map. The very
// arrays that the GPU gets.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "btf/vector.h"

namespace weft::cmf {

/// What a factor is a function of (the paper's p_i, p_h and p_o, table 1).
enum class Projection { light, half, view };

/// "light", "half" or "view".
std::string name_of(Projection projection);

/// RGB values of a texture: 8 bits (a byte is byte / 255) or float; the other one is empty.
struct RgbArray {
  std::vector<std::uint8_t> bytes;
  std::vector<float> floats;

  float value(std::size_t i) const {
    return floats.empty() ? static_cast<float>(bytes[i]) * (1.0F / 255.0F) : floats[i];
  }
  std::size_t size() const { return bytes.size() + floats.size(); }
  std::size_t texture_bytes() const { return bytes.size() + floats.size() * sizeof(float); }
  bool operator==(const RgbArray&) const = default;
};

/// Rounds 0..1 to 8 bits.
std::vector<std::uint8_t> to_bytes(const std::vector<float>& values);

/// One factor's maps: [map][row][column][rgb], each a parabolic map (see `ParabolicMap`).
struct Factor {
  Projection projection = Projection::light;
  RgbArray maps;
};

struct Model {
  int width = 0;
  int height = 0;
  int resolution = 0;  ///< texels a side of each map
  bool clustered =
      false;  ///< codebooks and an index map; otherwise texel y * width + x has map y * width + x
  std::vector<Factor> factors;
  /// [y][x][3]: which map of factors 0, 1, 2 a texel uses; unused channels are 0. Empty unless
  /// clustered.
  std::vector<std::uint8_t> index;
  /// S, [y][x][rgb], 0..1. In 8 bits its square root: on glossy data S differs by thousands from
  /// texel to texel, and equal steps would leave the dull texels none.
  RgbArray scale;
  Rgb scale_max;  ///< what 1 in S stands for, 1/sr
  HemisphereSampling views;
  HemisphereSampling lights;
  std::string parameters = "{}";  ///< JSON: every parameter of the fit, defaults too
  std::string provenance = "{}";  ///< JSON: the data's

  std::size_t values_a_map() const { return 3 * static_cast<std::size_t>(resolution) * resolution; }
  std::size_t map_count(std::size_t factor) const {
    return factors[factor].maps.size() / values_a_map();
  }
  /// S of a texel, 1/sr.
  Rgb scale_of(std::size_t texel) const {
    const Rgb stored(scale.value(3 * texel), scale.value(3 * texel + 1),
                     scale.value(3 * texel + 2));
    return scale_max * (scale.floats.empty() ? stored * stored : stored);
  }
  std::size_t map_of(std::size_t factor, std::size_t texel) const {
    return clustered ? index[3 * texel + factor] : texel;
  }
};

}  // namespace weft::cmf
