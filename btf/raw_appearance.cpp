#include "btf/raw_appearance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "btf/sample_blend.h"

namespace weft {

namespace {

// Which fine texels a coarse one covers along one axis, and with what share of itself.
struct Cover {
  int first;
  std::vector<double> share;
};

Cover cover(int coarse_index, int coarse_size, int fine_size) {
  const double begin = static_cast<double>(coarse_index) * fine_size / coarse_size;
  const double end = static_cast<double>(coarse_index + 1) * fine_size / coarse_size;
  Cover result{static_cast<int>(begin), {}};
  for (int i = result.first; i < fine_size && i < end; ++i) {
    const double overlap = std::min<double>(i + 1, end) - std::max<double>(i, begin);
    if (overlap > 1e-9) result.share.push_back(overlap / (end - begin));
  }
  return result;
}

}  // namespace

SampleStencil sample_stencil(const Stencil& views, const Stencil& lights,
                             std::span<const float> of_light, float factor) {
  SampleStencil samples;
  for (std::size_t v = 0; v < 3; ++v) {
    for (std::size_t l = 0; l < 3; ++l) {
      const std::size_t light = lights.index[l];
      samples.index[4 * v + l] =
          static_cast<std::int32_t>(views.index[v] * of_light.size() + light);
      samples.weight[4 * v + l] = views.weight[v] * (lights.weight[l] * of_light[light] * factor);
    }
  }
  return samples;
}

Rgb blended(const Btf& level, const TexelStencil& texels, const SampleStencil& samples) {
  return with_sample_blend(level, [&](const auto& blend) { return blend(texels, samples); });
}

Btf next_mip_level(const Btf& finer) {
  const int width = std::max(1, finer.width() / 2);
  const int height = std::max(1, finer.height() / 2);
  Btf coarse(width, height, finer.views(), finer.lights(), finer.pixel_type(), finer.memory());
  coarse.tile_size = finer.tile_size;
  const std::size_t count = 3 * finer.views().size() * finer.lights().size();
  tbb::parallel_for(0, width * height, [&](int texel) {
    const int x = texel % width;
    const int y = texel / width;
    const Cover columns = cover(x, width, finer.width());
    const Cover rows = cover(y, height, finer.height());
    std::vector<double> sum(count, 0.0);
    std::vector<float> fine(count);
    for (std::size_t j = 0; j < rows.share.size(); ++j) {
      for (std::size_t i = 0; i < columns.share.size(); ++i) {
        finer.abrdf(columns.first + static_cast<int>(i), rows.first + static_cast<int>(j), fine);
        const double share = columns.share[i] * rows.share[j];
        for (std::size_t k = 0; k < count; ++k) sum[k] += share * fine[k];
      }
    }
    std::size_t k = 0;
    for (std::size_t v = 0; v < finer.views().size(); ++v) {
      for (std::size_t l = 0; l < finer.lights().size(); ++l, k += 3) {
        coarse.set(l, v, x, y,
                   Rgb(static_cast<float>(sum[k]), static_cast<float>(sum[k + 1]),
                       static_cast<float>(sum[k + 2])));
      }
    }
  });
  return coarse;
}

std::vector<float> inverse_cosines(const HemisphereSampling& lights) {
  std::vector<float> inverse;
  for (const Direction& light : lights.directions()) {
    inverse.push_back(light.z > 1e-6F ? 1 / light.z : 0);
  }
  return inverse;
}

RawAppearance::RawAppearance(std::shared_ptr<const Btf> btf)
    : levels_{std::move(btf)}, inverse_cosines_(inverse_cosines(levels_[0]->lights())) {
  while (levels_.back()->width() > 1 || levels_.back()->height() > 1) {
    levels_.push_back(std::make_shared<const Btf>(next_mip_level(*levels_.back())));
  }
}

Rgb RawAppearance::evaluate(Texcoord uv, Direction light, Direction view, float lod) const {
  if (!(light.z > 0) || !(view.z > 0)) return {0, 0, 0};
  const SampleStencil samples =
      sample_stencil(levels_[0]->views().locate(view), levels_[0]->lights().locate(light),
                     inverse_cosines_, light.z);
  const auto at_level = [&](const Btf& btf) {
    return blended(btf, bilinear_texels(uv, btf.width(), btf.height()), samples);
  };
  const auto last = static_cast<float>(levels_.size() - 1);
  const float level = lod > 0 ? std::min(lod, last) : 0;  // a NaN is level 0
  const auto fine = static_cast<std::size_t>(level);
  const float blend = level - static_cast<float>(fine);
  const Rgb value = at_level(*levels_[fine]);
  return blend > 0 ? value * (1 - blend) + at_level(*levels_[fine + 1]) * blend : value;
}

}  // namespace weft
