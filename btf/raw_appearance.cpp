#include "btf/raw_appearance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

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

// Weighted samples of f = B / cos over the 3 x 3 neighbours, of one texel.
template <typename Value>
Rgb interpolate(const Value* abrdf, std::size_t n_lights, const Stencil& view, const Stencil& light,
                const std::array<float, 3>& light_weight) {
  Rgb sum(0, 0, 0);
  for (std::size_t v = 0; v < 3; ++v) {
    if (view.weight[v] == 0) continue;
    const Value* row = abrdf + 3 * n_lights * view.index[v];
    for (std::size_t l = 0; l < 3; ++l) {
      const Value* p = row + 3 * static_cast<std::size_t>(light.index[l]);
      const float w = view.weight[v] * light_weight[l];
      sum += Rgb(p[0], p[1], p[2]) * w;
    }
  }
  return sum;
}

Rgb evaluate_level(const Btf& btf, const Texcoord& uv, const Stencil& view, const Stencil& light,
                   const std::array<float, 3>& light_weight) {
  const TexelStencil texels = bilinear_texels(uv, btf.width(), btf.height());
  const std::size_t stride = 3 * btf.views().size() * btf.lights().size();
  Rgb sum(0, 0, 0);
  for (std::size_t i = 0; i < 4; ++i) {
    if (texels.weight[i] == 0) continue;
    const std::size_t first = texels.index[i] * stride;
    const Rgb value = btf.pixel_type() == PixelType::half
                          ? interpolate(btf.halfs().data() + first, btf.lights().size(), view,
                                        light, light_weight)
                          : interpolate(btf.floats().data() + first, btf.lights().size(), view,
                                        light, light_weight);
    sum += value * texels.weight[i];
  }
  return sum;
}

}  // namespace

TexelStencil bilinear_texels(Texcoord uv, int width, int height) {
  const AxisStencil x = column_stencil(uv, width);
  const AxisStencil y = row_stencil(uv, height);
  const std::uint32_t low = y.low * static_cast<std::uint32_t>(width);
  const std::uint32_t high = y.high * static_cast<std::uint32_t>(width);
  return {{low + x.low, low + x.high, high + x.low, high + x.high},
          {(1 - x.blend) * (1 - y.blend), x.blend * (1 - y.blend), (1 - x.blend) * y.blend,
           x.blend * y.blend}};
}

Btf next_mip_level(const Btf& finer) {
  const int width = std::max(1, finer.width() / 2);
  const int height = std::max(1, finer.height() / 2);
  Btf coarse(width, height, finer.views(), finer.lights(), finer.pixel_type());
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
  const Stencil views = levels_[0]->views().locate(view);
  const Stencil lights = levels_[0]->lights().locate(light);
  std::array<float, 3> light_weight;
  for (std::size_t i = 0; i < 3; ++i) {
    light_weight[i] = lights.weight[i] * inverse_cosines_[lights.index[i]] * light.z;
  }
  const auto last = static_cast<float>(levels_.size() - 1);
  const float level = lod > 0 ? std::min(lod, last) : 0;  // a NaN is level 0
  const auto fine = static_cast<std::size_t>(level);
  const float blend = level - static_cast<float>(fine);
  Rgb value = evaluate_level(*levels_[fine], uv, views, lights, light_weight);
  if (blend > 0) {
    const Rgb coarse = evaluate_level(*levels_[fine + 1], uv, views, lights, light_weight);
    value = value * (1 - blend) + coarse * blend;
  }
  return value;
}

}  // namespace weft
