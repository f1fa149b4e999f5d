#include "codecs/factor_maps/texel_source.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "btf/error.h"
#include "btf/raw_appearance.h"

namespace weft::factor_maps {

namespace {

Error invalid_sample(const Level& level, std::size_t light, std::size_t view, std::size_t texel,
                     float value) {
  const std::size_t inside = texel - level.first;
  const auto width = static_cast<std::size_t>(level.width);
  return bad_input(
      "BTF", fmt::format("view {}, light {}, texel ({}, {}): {} is not a finite number >= 0", view,
                         light, inside % width, inside / width, value));
}

// Each light, or for one on the horizon the nearest that is above it; itself where none is.
std::vector<std::size_t> lights_above(const HemisphereSampling& lights,
                                      const std::vector<float>& inverse_cosine) {
  std::vector<std::size_t> result(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    result[i] = i;
    float largest = -2;
    for (std::size_t j = 0; inverse_cosine[i] == 0 && j < lights.size(); ++j) {
      const float cosine = lights[i] ^ lights[j];
      if (inverse_cosine[j] == 0 || !(cosine > largest)) continue;
      largest = cosine;
      result[i] = j;
    }
  }
  return result;
}

}  // namespace

TexelSource::TexelSource(std::shared_ptr<const Btf> btf, bool with_levels)
    : btfs_{std::move(btf)},
      levels_(mip_levels(btfs_[0]->width(), btfs_[0]->height())),
      inverse_cosine_(inverse_cosines(btfs_[0]->lights())),
      light_of_(lights_above(btfs_[0]->lights(), inverse_cosine_)) {
  if (!with_levels) levels_.resize(1);
  while (btfs_.size() < levels_.size()) {
    btfs_.push_back(std::make_shared<const Btf>(next_mip_level(*btfs_.back())));
  }
}

std::size_t TexelSource::size() const {
  const Level& last = levels_.back();
  return last.first + static_cast<std::size_t>(last.width) * last.height;
}

void TexelSource::abrdf(std::size_t texel, std::span<float> values) const {
  std::size_t level = levels_.size() - 1;
  while (levels_[level].first > texel) --level;
  const auto inside = static_cast<int>(texel - levels_[level].first);
  btfs_[level]->abrdf(inside % levels_[level].width, inside / levels_[level].width, values);
}

LaneVector TexelSource::block(std::span<const std::size_t> texels) const {
  const std::size_t n_lights = finest().lights().size();
  const std::size_t n_views = finest().views().size();
  LaneVector f(n_lights * n_views);
  std::vector<float> values(3 * f.size());
  for (std::size_t t = 0; t < texels.size(); ++t) {
    abrdf(texels[t], values);
    for (std::size_t view = 0; view < n_views; ++view) {
      for (std::size_t light = 0; light < n_lights; ++light) {
        const std::size_t source = light_of_[light];
        const float* p = &values[3 * (view * n_lights + source)];
        Lanes& lanes = f[light * n_views + view];
        for (int c = 0; c < 3; ++c) {
          const float own = values[3 * (view * n_lights + light) + c];
          if (!(own >= 0) || !std::isfinite(own)) {
            std::size_t level = levels_.size() - 1;
            while (levels_[level].first > texels[t]) --level;
            throw invalid_sample(levels_[level], light, view, texels[t], own);
          }
          lanes[3 * static_cast<int>(t) + c] = p[c] * inverse_cosine_[source];
        }
      }
    }
  }
  return f;
}

}  // namespace weft::factor_maps
