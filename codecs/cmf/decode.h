// From a model to values: one texel's ABRDF f(light, view) as the product of its maps' bilinear
// lookups.
#pragma once

#include <array>

#include "codecs/cmf/half_difference.h"
#include "codecs/cmf/model.h"
#include "codecs/cmf/parabolic_map.h"

namespace weft::cmf {

/// Taps of each factor for one pair of directions; at most three factors.
using FactorTaps = std::array<BilinearTaps, 3>;

inline FactorTaps factor_taps(const Model& model, const Direction& light, const Direction& view) {
  const ParabolicMap map(model.resolution);
  FactorTaps taps{};
  for (std::size_t f = 0; f < model.factors.size(); ++f) {
    switch (model.factors[f].projection) {
      case Projection::light:
        taps[f] = map.taps(light);
        break;
      case Projection::half:
        taps[f] = map.taps(half_vector(light, view));
        break;
      case Projection::view:
        taps[f] = map.taps(view);
        break;
    }
  }
  return taps;
}

/// Bilinear lookup in one map; for bytes in units of 1/255.
template <typename Value>
Rgb looked_up(const Value* map, const BilinearTaps& taps) {
  Rgb sum(0, 0, 0);
  for (std::size_t k = 0; k < 4; ++k) {
    const Value* p = map + 3 * static_cast<std::size_t>(taps.index[k]);
    sum += Rgb(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])) *
           taps.weight[k];
  }
  return sum;
}

/// P Q R of one texel, without scale and cosine.
inline Rgb factor_product(const Model& model, std::size_t texel, const FactorTaps& taps) {
  Rgb product(1, 1, 1);
  for (std::size_t f = 0; f < model.factors.size(); ++f) {
    const RgbArray& maps = model.factors[f].maps;
    const std::size_t first = model.map_of(f, texel) * model.values_a_map();
    product *= maps.floats.empty() ? looked_up(&maps.bytes[first], taps[f]) * (1.0F / 255.0F)
                                   : looked_up(&maps.floats[first], taps[f]);
  }
  return product;
}

}  // namespace weft::cmf
