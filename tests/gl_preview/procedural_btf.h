// A small BTF with what real ones have: colour that changes over the tile, bumps, a highlight that
// moves.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>

#include "btf/btf.h"

/// Diffuse stripes and a glossy lobe about a normal that tilts over the tile.
inline std::shared_ptr<const weft::Btf> procedural_btf(int width, int height,
                                                       const std::string& directions,
                                                       weft::PixelType type) {
  using weft::Rgb;
  using weft::Vec3;
  const weft::HemisphereSampling sampling(weft::named_directions(directions));
  auto btf = std::make_shared<weft::Btf>(width, height, sampling, sampling, type);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float phase = 2 * std::numbers::pi_v<float> * (x + 0.5F) / width;
      const float rise = 2 * std::numbers::pi_v<float> * (y + 0.5F) / height;
      const Vec3 normal = Vec3(0.4F * std::sin(phase), 0.3F * std::cos(rise), 1).normalized();
      const Rgb base(0.5F + 0.3F * std::cos(phase), 0.3F, 0.4F + 0.2F * std::sin(rise));
      for (std::size_t v = 0; v < sampling.size(); ++v) {
        for (std::size_t l = 0; l < sampling.size(); ++l) {
          const Vec3 half = (sampling[l] + sampling[v]).normalized();
          const float diffuse = std::max(0.0F, normal.dot(sampling[l])) / std::numbers::pi_v<float>;
          const float gloss =
              0.8F * std::pow(std::max(0.0F, normal.dot(half)), 20.0F) * sampling[l].z;
          btf->set(l, v, x, y, base * diffuse + Rgb(gloss, gloss, gloss));
        }
      }
    }
  }
  return btf;
}
