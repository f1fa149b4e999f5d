#include "codecs/laplacian/laplacian_representation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "btf/raw_appearance.h"
#include "codecs/branchless_exp.h"
#include "codecs/laplacian/colour.h"

namespace weft::laplacian {

namespace {

constexpr std::size_t most_slots = 96;

/// Four slots side by side, and sixteen.
using Vec4 = float __attribute__((vector_size(16)));
using Vec16 = float __attribute__((vector_size(64)));

template <typename Lanes>
Lanes load(const float* p) {
  Lanes v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}

// lambda of section 3.4, step 2.
float level_of(float lod, int top) {
  return lod > 0 ? std::min(lod, static_cast<float>(top)) : 0;  // a NaN is level 0
}

Corners corners(Texcoord uv, int width, int height) {
  const AxisStencil x = column_stencil(uv, width);
  const AxisStencil y = row_stencil(uv, height);
  return {{static_cast<int>(x.low), static_cast<int>(x.high)},
          {static_cast<int>(y.low), static_cast<int>(y.high)},
          {(1 - x.blend) * (1 - y.blend), x.blend * (1 - y.blend), (1 - x.blend) * y.blend,
           x.blend * y.blend}};
}

// Equation 5, side by side.
std::array<float, batch_lanes> phong_means(const Phong& phong,
                                           const std::array<Direction, batch_lanes>& light,
                                           const std::array<Direction, batch_lanes>& view) {
  alignas(64) std::array<float, batch_lanes> cosine;
  alignas(64) std::array<float, batch_lanes> light_cosine;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const Direction sum = light[i] + view[i];
    cosine[i] = sum.z / std::sqrt(sum ^ sum);
    light_cosine[i] = light[i].z;
  }
  std::array<float, batch_lanes> mean;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const float lobe = branchless_exp(phong.alpha * branchless_log(std::max(cosine[i], 1e-30F)));
    mean[i] = phong.ka + phong.kd * light_cosine[i] + phong.ks * lobe;
  }
  return mean;
}

}  // namespace

// Where a query stands in the pyramid: lambda = level + blend, and the four texels of that level.
struct LaplacianRepresentation::Place {
  int level;
  float blend;
  Corners corners;
};

struct LaplacianRepresentation::Pairs {
  std::size_t count = 0;
  std::array<std::size_t, 9> index;
  std::array<float, 9> weight;
};

struct LaplacianRepresentation::Blend {
  std::array<std::uint32_t, 4> texel;
  std::array<float, 4> weight;
};

LaplacianRepresentation::LaplacianRepresentation(Model model)
    : model_(std::move(model)),
      view_locator_(model_.head.views),
      light_locator_(model_.head.lights),
      nearest_view_(model_.head.views),
      nearest_light_(model_.head.lights) {
  for (int level = 0; level < model_.levels(); ++level)
    first_row_.push_back(model_.first_weight_row(level));
  const std::vector<float> inverse = inverse_cosines(model_.head.lights);
  const std::size_t slots = model_.slots();
  const std::size_t levels = static_cast<std::size_t>(model_.levels());
  weights_ = model_.weights;
  weights_.resize(weights_.size() + 4);  // where the last row's sixteen lanes end
  eigen_.resize(model_.eigen.size() + 4);
  for (std::size_t pair = 0; pair < model_.head.pairs(); ++pair) {
    const float factor = model_.interpolated ? inverse[pair % inverse.size()] : 1;
    for (std::size_t level = 0; level < levels; ++level) {
      for (std::size_t slot = 0; slot < slots; ++slot) {
        eigen_[(pair * levels + level) * slots + slot] =
            model_.eigen[(level * model_.head.pairs() + pair) * slots + slot] *
            model_.scale[level * slots + slot] * factor;
      }
    }
  }
}

// Section 3.4, step 1.
LaplacianRepresentation::Pairs LaplacianRepresentation::nearest_pair(const Direction& light,
                                                                     const Direction& view) const {
  Pairs pairs;
  pairs.count = 1;
  pairs.index[0] = nearest_view_(view) * model_.head.lights.size() + nearest_light_(light);
  pairs.weight[0] = 1;
  return pairs;
}

LaplacianRepresentation::Pairs LaplacianRepresentation::weighted_pairs(const Stencil& lights,
                                                                       const Stencil& views,
                                                                       float cosine) const {
  Pairs pairs;
  pairs.index[0] = 0;  // asked for even where all weights fade to zero
  pairs.weight[0] = 0;
  for (std::size_t v = 0; v < 3; ++v) {
    for (std::size_t l = 0; l < 3; ++l) {
      const float weight = views.weight[v] * lights.weight[l];
      if (weight == 0) continue;
      pairs.index[pairs.count] = views.index[v] * model_.head.lights.size() + lights.index[l];
      pairs.weight[pairs.count++] = weight * cosine;
    }
  }
  return pairs;
}

LaplacianRepresentation::Place LaplacianRepresentation::place_of(Texcoord uv, float lod) const {
  const float lambda = level_of(lod, model_.pyramid.top);
  const int level = static_cast<int>(lambda);
  return {level, lambda - static_cast<float>(level),
          corners(uv, model_.pyramid.width_of(level), model_.pyramid.height_of(level))};
}

// D^T E of one level, slot by slot. The paper's twelve slots are one vector of sixteen: its last
// four lanes hold the beginning of the next row, and nobody adds them up.
template <std::size_t Quads>
[[gnu::always_inline]] inline void LaplacianRepresentation::add_level(int level, const Blend& blend,
                                                                      const Pairs& pairs,
                                                                      float* sum) const {
  using Lanes = std::conditional_t<Quads == 3, Vec16, Vec4>;
  constexpr std::size_t step = sizeof(Lanes) / sizeof(float);
  const std::size_t slots = 4 * (Quads > 0 ? Quads : model_.quads());
  const std::size_t stride = model_.levels() * slots;
  const float* weights = &weights_[first_row_[level] * slots];
  const float* eigen = &eigen_[level * slots];
  for (std::size_t s = 0; s < slots; s += step) {
    Lanes d{};
    for (std::size_t t = 0; t < 4; ++t)
      d += load<Lanes>(weights + blend.texel[t] * slots + s) * blend.weight[t];
    Lanes e = load<Lanes>(eigen + pairs.index[0] * stride + s) * pairs.weight[0];
    for (std::size_t i = 1; i < pairs.count; ++i)
      e += load<Lanes>(eigen + pairs.index[i] * stride + s) * pairs.weight[i];
    const Lanes total = load<Lanes>(sum + s) + d * e;
    __builtin_memcpy(sum + s, &total, sizeof total);
  }
}

// What the levels from `grid` on say at the four texels of that level around uv.
template <std::size_t Quads>
[[gnu::always_inline]] inline void LaplacianRepresentation::add_boxes(const Corners& c, int grid,
                                                                      float weight,
                                                                      const Pairs& pairs,
                                                                      float* sum) const {
  const Pyramid& pyramid = model_.pyramid;
  Blend blend;
  for (std::size_t t = 0; t < 4; ++t) blend.weight[t] = c.weight[t] * weight;
  for (int level = grid; level <= pyramid.top; ++level) {
    const int width = pyramid.width_of(level);
    const int height = pyramid.height_of(level);
    for (std::size_t t = 0; t < 4; ++t) {
      blend.texel[t] = static_cast<std::uint32_t>(parent(c.y[t / 2], level - grid, height) * width +
                                                  parent(c.x[t % 2], level - grid, width));
    }
    add_level<Quads>(level, blend, pairs, sum);
  }
}

template <std::size_t Quads>
void LaplacianRepresentation::add_levels(Texcoord uv, const Place& place, const Pairs& pairs,
                                         float* sum) const {
  const Pyramid& pyramid = model_.pyramid;
  if (pyramid.filters != Filters::linear) {
    add_boxes<Quads>(place.corners, place.level, 1 - place.blend, pairs, sum);
    if (place.blend == 0) return;
    const int next = place.level + 1;
    return add_boxes<Quads>(corners(uv, pyramid.width_of(next), pyramid.height_of(next)), next,
                            place.blend, pairs, sum);
  }
  for (int level = place.level; level <= pyramid.top; ++level) {
    const float w = level == place.level ? 1 - place.blend : 1;  // w_k
    TexelStencil texels = bilinear_texels(uv, pyramid.width_of(level), pyramid.height_of(level));
    for (float& weight : texels.weight) weight *= w;
    add_level<Quads>(level, {texels.index, texels.weight}, pairs, sum);
  }
}

// Equation 7.
Rgb LaplacianRepresentation::decode(const AppearanceQuery& query, const Place& place,
                                    const Pairs& pairs, float mean_y) const {
  alignas(64) std::array<float, most_slots> sum;
  if (model_.quads() == 3) {
    std::fill_n(sum.begin(), 16, 0.0F);
    add_levels<3>(query.uv, place, pairs, sum.data());
  } else {
    std::fill_n(sum.begin(), model_.slots(), 0.0F);
    add_levels<0>(query.uv, place, pairs, sum.data());
  }
  std::array<float, 3> channel{mean_y, model_.mean_chroma[0], model_.mean_chroma[1]};
  if (model_.chroma == ChromaMean::cosine) {
    channel[1] *= query.light.z;
    channel[2] *= query.light.z;
  }
  Vec4 luma{};
  for (std::size_t quad = 0; quad < model_.luma_quads(); ++quad)
    luma += load<Vec4>(sum.data() + 4 * quad);
  channel[0] += (luma[0] + luma[2]) + (luma[1] + luma[3]);
  for (std::size_t c = 1; c < 3; ++c) {
    const float* slot = sum.data() + model_.first_slot(c);
    for (std::size_t k = 0; k < model_.components[c]; ++k) channel[c] += slot[k];
  }
  Rgb rgb = rgb_of_ycbcr(channel[0], channel[1], channel[2]);
  for (int c = 0; c < 3; ++c) rgb[c] = rgb[c] < 0 ? 0 : rgb[c];  // a NaN stays one
  return rgb;
}

Rgb LaplacianRepresentation::evaluate(Texcoord uv, Direction light, Direction view,
                                      float lod) const {
  if (!(light.z > 0) || !(view.z > 0)) return {0, 0, 0};
  const Pairs pairs = model_.interpolated ? weighted_pairs(model_.head.lights.locate(light),
                                                           model_.head.views.locate(view), light.z)
                                          : nearest_pair(light, view);
  return decode({uv, light, view, lod}, place_of(uv, lod), pairs, model_.mean_y(light, view));
}

void LaplacianRepresentation::evaluate(std::span<const AppearanceQuery> queries,
                                       std::span<Rgb> answers) const {
  for (std::size_t first = 0; first < queries.size(); first += batch_lanes) {
    const std::size_t count = std::min<std::size_t>(batch_lanes, queries.size() - first);
    std::array<Direction, batch_lanes> light;
    std::array<Direction, batch_lanes> view;
    std::array<bool, batch_lanes> is_seen;
    for (std::size_t i = 0; i < batch_lanes; ++i) {
      const AppearanceQuery& query = queries[first + std::min(i, count - 1)];
      is_seen[i] = query.light.z > 0 && query.view.z > 0;
      light[i] = is_seen[i] ? query.light : Direction(0, 0, 1);
      view[i] = is_seen[i] ? query.view : Direction(0, 0, 1);
    }
    const std::array<Pairs, batch_lanes> pairs = pairs_of(light, view);
    const std::array<float, batch_lanes> mean = phong_means(model_.mean_y, light, view);
    for (std::size_t i = 0; i < count; ++i) {
      const AppearanceQuery& query = queries[first + i];
      answers[first + i] = is_seen[i]
                               ? decode(query, place_of(query.uv, query.lod), pairs[i], mean[i])
                               : Rgb(0, 0, 0);
    }
  }
}

std::array<LaplacianRepresentation::Pairs, batch_lanes> LaplacianRepresentation::pairs_of(
    const std::array<Direction, batch_lanes>& light,
    const std::array<Direction, batch_lanes>& view) const {
  std::array<Pairs, batch_lanes> pairs;
  if (!model_.interpolated) {
    for (std::size_t i = 0; i < batch_lanes; ++i) pairs[i] = nearest_pair(light[i], view[i]);
    return pairs;
  }
  const StencilBatch views = view_locator_.locate(model_.head.views, view);
  const StencilBatch lights = light_locator_.locate(model_.head.lights, light);
  for (std::size_t i = 0; i < batch_lanes; ++i)
    pairs[i] = weighted_pairs(lights.lane(i), views.lane(i), light[i].z);
  return pairs;
}

std::size_t LaplacianRepresentation::constant_bytes() const {
  const std::size_t numbers = model_.scale.size() + 6;
  if (!model_.interpolated)
    return nearest_view_.bytes() + nearest_light_.bytes() + numbers * sizeof(float);
  return direction_table_bytes(model_.head) + (numbers + model_.head.lights.size()) * sizeof(float);
}

void LaplacianRepresentation::save(const std::filesystem::path& folder) const {
  write_model(folder, model_);
}

}  // namespace weft::laplacian
