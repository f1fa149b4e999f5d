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
Batch<float> phong_means(const Phong& phong, const QueryBatch& batch) {
  alignas(64) Batch<float> mean;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const float x = batch.light.x[i] + batch.view.x[i];
    const float y = batch.light.y[i] + batch.view.y[i];
    const float z = batch.light.z[i] + batch.view.z[i];
    const float cosine = z / std::sqrt(x * x + y * y + z * z);
    const float lobe = branchless_exp(phong.alpha * branchless_log(std::max(cosine, 1e-30F)));
    mean[i] = phong.ka + phong.kd * batch.light.z[i] + phong.ks * lobe;
  }
  return mean;
}

// Texels of the levels `grid` around uv, whose parents count with the same weights.
struct BoxBatch {
  Batch<std::int32_t> grid;
  AxisBatch x;
  AxisBatch y;
  std::array<Batch<float>, 4> weight;
};

BoxBatch box_batch(const Pyramid& pyramid, const QueryBatch& batch, const Batch<std::int32_t>& grid,
                   const Batch<float>& share) {
  alignas(64) Batch<std::int32_t> width;
  alignas(64) Batch<std::int32_t> height;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    width[i] = pyramid.width >> grid[i];
    height[i] = pyramid.height >> grid[i];
  }
  BoxBatch boxes{grid, column_batch(batch.u, width), row_batch(batch.v, height), {}};
  boxes.weight = texel_batch(boxes.x, boxes.y, width).weight;
  for (Batch<float>& weight : boxes.weight) {
    for (std::size_t i = 0; i < batch_lanes; ++i) weight[i] *= share[i];
  }
  return boxes;
}

// Lanes whose grid is coarser than `level` have weight 0.
TexelBatch box_texels(const Pyramid& pyramid, const BoxBatch& boxes, int level) {
  const int width = pyramid.width_of(level);
  const int height = pyramid.height_of(level);
  TexelBatch texels;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const int between = std::max(level - boxes.grid[i], 0);
    const int left = parent(boxes.x.low[i], between, width);
    const int right = parent(boxes.x.high[i], between, width);
    const int upper = width * parent(boxes.y.low[i], between, height);
    const int lower = width * parent(boxes.y.high[i], between, height);
    texels.index[0][i] = upper + left;
    texels.index[1][i] = upper + right;
    texels.index[2][i] = lower + left;
    texels.index[3][i] = lower + right;
    for (std::size_t t = 0; t < 4; ++t)
      texels.weight[t][i] = level < boxes.grid[i] ? 0 : boxes.weight[t][i];
  }
  return texels;
}

TexelBatch linear_texels(const Pyramid& pyramid, const QueryBatch& batch, const LevelBatch& lambda,
                         int level) {
  TexelBatch texels = texel_batch(batch, pyramid.width_of(level), pyramid.height_of(level));
  for (Batch<float>& weight : texels.weight) {
    for (std::size_t i = 0; i < batch_lanes; ++i)  // w_k
      weight[i] *= level < lambda.fine[i] ? 0 : level == lambda.fine[i] ? 1 - lambda.blend[i] : 1;
  }
  return texels;
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
      nearest_light_(model_.head.lights),
      inverse_cosines_(inverse_cosines(model_.head.lights)),
      stride_(model_.quads() == 3 ? 16 : model_.slots()) {
  for (int level = 0; level < model_.levels(); ++level)
    first_row_.push_back(model_.first_weight_row(level));
  const std::size_t slots = model_.slots();
  const std::size_t levels = static_cast<std::size_t>(model_.levels());
  for (std::size_t c = 0; c < 3; ++c) {
    is_of_channel_[c].resize(slots);
    std::fill_n(&is_of_channel_[c][model_.first_slot(c)], model_.components[c], 1.0F);
  }
  weights_.resize(model_.weights.size() / slots * stride_);
  for (std::size_t row = 0; row * slots < model_.weights.size(); ++row)
    std::copy_n(&model_.weights[row * slots], slots, &weights_[row * stride_]);
  eigen_.resize(model_.eigen.size() / slots * stride_);
  for (std::size_t pair = 0; pair < model_.head.pairs(); ++pair) {
    for (std::size_t level = 0; level < levels; ++level) {
      for (std::size_t slot = 0; slot < slots; ++slot) {
        eigen_[(pair * levels + level) * stride_ + slot] =
            model_.eigen[(level * model_.head.pairs() + pair) * slots + slot] *
            model_.scale[level * slots + slot];
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

LaplacianRepresentation::Pairs LaplacianRepresentation::weighted_pairs(
    const PairLane& found) const {
  Pairs pairs;
  for (std::size_t v = 0; v < 3; ++v) {
    for (std::size_t i = 4 * v; i < 4 * v + 3; ++i) {
      pairs.index[pairs.count] = found.index[i];
      pairs.weight[pairs.count++] = found.weight[i];
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

// D^T E of one level, slot by slot. The paper's twelve slots are one vector of sixteen.
template <std::size_t Quads>
[[gnu::always_inline]] inline void LaplacianRepresentation::add_level(int level, const Blend& blend,
                                                                      const Pairs& pairs,
                                                                      float* sum) const {
  using RowLanes = std::conditional_t<Quads == 3, Vec16, Vec4>;
  constexpr std::size_t step = sizeof(RowLanes) / sizeof(float);
  const std::size_t row = Quads == 3 ? 16 : stride_;
  const std::size_t stride = model_.levels() * row;
  const float* weights = &weights_[first_row_[level] * row];
  const float* eigen = &eigen_[level * row];
  for (std::size_t s = 0; s < row; s += step) {
    RowLanes d{};
    for (std::size_t t = 0; t < 4; ++t)
      d += load<RowLanes>(weights + blend.texel[t] * row + s) * blend.weight[t];
    RowLanes e = load<RowLanes>(eigen + pairs.index[0] * stride + s) * pairs.weight[0];
    for (std::size_t i = 1; i < pairs.count; ++i)
      e += load<RowLanes>(eigen + pairs.index[i] * stride + s) * pairs.weight[i];
    add_to(sum + s, d * e);
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

// Each channel's slots of the levels' sums, four partial sums of them.
template <std::size_t Quads>
[[gnu::always_inline]] inline std::array<Vec4, 3> LaplacianRepresentation::channel_sums(
    const float* sum) const {
  const std::size_t quads = Quads > 0 ? Quads : model_.quads();
  std::array<Vec4, 3> channel{};
  for (std::size_t q = 0; q < quads; ++q) {
    for (std::size_t c = 0; c < 3; ++c)
      channel[c] += load<Vec4>(sum + 4 * q) * load<Vec4>(&is_of_channel_[c][4 * q]);
  }
  return channel;
}

// Equation 7, but for its sums over the levels.
Rgb LaplacianRepresentation::colour(float y, float cb, float cr, float mean_y,
                                    float light_cosine) const {
  const float share = model_.chroma == ChromaMean::cosine ? light_cosine : 1;
  const Rgb rgb = rgb_of_ycbcr(mean_y + y, model_.mean_chroma[0] * share + cb,
                               model_.mean_chroma[1] * share + cr);
  const auto not_negative = [](float x) { return x < 0 ? 0 : x; };  // a NaN stays one
  return {not_negative(rgb.x), not_negative(rgb.y), not_negative(rgb.z)};
}

Rgb LaplacianRepresentation::evaluate(Texcoord uv, Direction light, Direction view,
                                      float lod) const {
  if (!(light.z > 0) || !(view.z > 0)) return {0, 0, 0};
  const Pairs pairs =
      model_.interpolated
          ? weighted_pairs(pair_lane(model_.head.views.locate(view),
                                     model_.head.lights.locate(light), inverse_cosines_, light.z))
          : nearest_pair(light, view);
  const Place place = place_of(uv, lod);
  alignas(64) std::array<float, most_slots> sum;
  std::fill_n(sum.begin(), stride_, 0.0F);
  if (model_.quads() == 3)
    add_levels<3>(uv, place, pairs, sum.data());
  else
    add_levels<0>(uv, place, pairs, sum.data());
  const std::array<Vec4, 3> channel = channel_sums<0>(sum.data());
  return colour(sum_of(channel[0]), sum_of(channel[1]), sum_of(channel[2]),
                model_.mean_y(light, view), light.z);
}

void LaplacianRepresentation::evaluate(std::span<const AppearanceQuery> queries,
                                       std::span<Rgb> answers) const {
  decode_in_batches(queries, answers, [this](const QueryBatch& batch) {
    return model_.quads() == 3 ? decode<3>(batch) : decode<0>(batch);
  });
}

// The levels one after the other, each of all lanes.
template <std::size_t Quads>
Batch<Rgb> LaplacianRepresentation::decode(const QueryBatch& batch) const {
  const Batch<Pairs> pairs = pairs_of(batch);
  const Batch<float> mean = phong_means(model_.mean_y, batch);
  alignas(64) std::array<float, batch_lanes*(Quads == 3 ? 16 : most_slots)> sums;
  std::fill_n(sums.begin(), batch_lanes * stride_, 0.0F);
  const Pyramid& pyramid = model_.pyramid;
  const LevelBatch lambda = level_batch(batch.lod, static_cast<std::size_t>(model_.levels()));
  const auto add = [&](int level, const TexelBatch& texels) {
    for (std::size_t i = 0; i < batch_lanes; ++i) {
      Blend rows;
      for (std::size_t t = 0; t < 4; ++t) {
        rows.texel[t] = static_cast<std::uint32_t>(texels.index[t][i]);
        rows.weight[t] = texels.weight[t][i];
      }
      add_level<Quads>(level, rows, pairs[i], &sums[i * stride_]);
    }
  };
  if (pyramid.filters == Filters::linear) {
    for (int level = std::ranges::min(lambda.fine); level <= pyramid.top; ++level)
      add(level, linear_texels(pyramid, batch, lambda, level));
  } else {
    const auto add_boxes = [&](const BoxBatch& boxes) {
      for (int level = std::ranges::min(boxes.grid); level <= pyramid.top; ++level)
        add(level, box_texels(pyramid, boxes, level));
    };
    alignas(64) Batch<float> rest;
    for (std::size_t i = 0; i < batch_lanes; ++i) rest[i] = 1 - lambda.blend[i];
    add_boxes(box_batch(pyramid, batch, lambda.fine, rest));
    if (std::ranges::max(lambda.blend) > 0)
      add_boxes(box_batch(pyramid, batch, lambda.coarse, lambda.blend));
  }
  alignas(64) std::array<Batch<Vec4>, 3> channels;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const std::array<Vec4, 3> channel = channel_sums<Quads>(&sums[i * stride_]);
    for (std::size_t c = 0; c < 3; ++c) channels[c][i] = channel[c];
  }
  Batch<Rgb> values;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    values[i] = colour(sum_of(channels[0][i]), sum_of(channels[1][i]), sum_of(channels[2][i]),
                       mean[i], batch.light.z[i]);
  }
  return values;
}

Batch<LaplacianRepresentation::Pairs> LaplacianRepresentation::pairs_of(
    const QueryBatch& batch) const {
  Batch<Pairs> pairs;
  if (model_.interpolated) {
    const Batch<PairLane> found = pair_batch(view_locator_.locate(model_.head.views, batch.view),
                                             light_locator_.locate(model_.head.lights, batch.light),
                                             inverse_cosines_, batch.light.z);
    for (std::size_t i = 0; i < batch_lanes; ++i) pairs[i] = weighted_pairs(found[i]);
  } else {
    const Batch<std::int32_t> views = nearest_view_(batch.view);
    const Batch<std::int32_t> lights = nearest_light_(batch.light);
    for (std::size_t i = 0; i < batch_lanes; ++i) {
      pairs[i].count = 1;
      pairs[i].index[0] = views[i] * model_.head.lights.size() + lights[i];
      pairs[i].weight[0] = 1;
    }
  }
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
