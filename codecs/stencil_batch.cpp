#include "codecs/stencil_batch.h"

#include <cmath>
#include <cstring>

#include "codecs/transposed_lanes.h"
#include "codecs/wide_vector.h"

namespace weft {

namespace {

// Straight into its place: what is returned is copied, and waits for its own writing.
inline void set_pairs(const StencilLane& views, const StencilLane& lights,
                      std::span<const float> of_light, float factor, PairLane& pairs) {
  Vec4 light = load<Vec4>(lights.weight.data());
  light *= Vec4{of_light[lights.index[0]], of_light[lights.index[1]], of_light[lights.index[2]], 0};
  Int4 index;
  std::memcpy(&index, lights.index.data(), sizeof index);
  const auto n_lights = static_cast<std::int32_t>(of_light.size());
  for (std::size_t v = 0; v < 3; ++v) {
    const Vec4 w = light * (views.weight[v] * factor);
    const Int4 k = index + views.index[v] * n_lights;
    std::memcpy(&pairs.weight[4 * v], &w, sizeof w);
    std::memcpy(&pairs.index[4 * v], &k, sizeof k);
  }
  std::memcpy(&index, views.index.data(), sizeof index);
  std::memcpy(pairs.view.data(), &index, sizeof index);
}

// `place` counts texels from the first one's centre, and is in [-0.5, size - 0.5] or a NaN.
AxisBatch axis_batch(const Batch<float>& place, const Batch<std::int32_t>& size) {
  AxisBatch axis;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const float below = std::floor(place[i]);
    axis.blend[i] = place[i] - below;
    const std::int32_t low = below >= 0 ? static_cast<std::int32_t>(below) : size[i] - 1;
    axis.low[i] = low >= size[i] ? 0 : low;
    axis.high[i] = axis.low[i] + 1 >= size[i] ? 0 : axis.low[i] + 1;
  }
  return axis;
}

static_assert(sizeof(AppearanceQuery) == 9 * sizeof(float));

#ifdef __AVX512F__
void spread(const AppearanceQuery* queries, QueryBatch& batch) {
  constexpr std::size_t stride = 9;
  const float* first = &queries[0].uv.x;
  const auto four_from = [&](std::size_t k) {
    return lanes_at([&](std::size_t lane) { return first + k + lane * stride; });
  };
  const auto store = [](const Vec16& values, Batch<float>& lanes) {
    std::memcpy(lanes.data(), &values, sizeof values);
  };
  const std::array<Vec16, 4> front = four_from(0);  // u, v, x and y of light
  store(front[0], batch.u);
  store(front[1], batch.v);
  store(front[2], batch.light.x);
  store(front[3], batch.light.y);
  const std::array<Vec16, 4> back = four_from(4);  // its z, and view
  store(back[0], batch.light.z);
  store(back[1], batch.view.x);
  store(back[2], batch.view.y);
  store(back[3], batch.view.z);
  const auto lod = [&](std::size_t i) {
    return Vec4{queries[i].lod, queries[i + 1].lod, queries[i + 2].lod, queries[i + 3].lod};
  };
  store(joined(joined(lod(0), lod(4)), joined(lod(8), lod(12))), batch.lod);
}
#else
void spread(const AppearanceQuery* queries, QueryBatch& batch) {
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const AppearanceQuery& q = queries[i];
    batch.u[i] = q.uv.x;
    batch.v[i] = q.uv.y;
    batch.lod[i] = q.lod;
    batch.light.x[i] = q.light.x;
    batch.light.y[i] = q.light.y;
    batch.light.z[i] = q.light.z;
    batch.view.x[i] = q.view.x;
    batch.view.y[i] = q.view.y;
    batch.view.z[i] = q.view.z;
  }
}
#endif

}  // namespace

QueryBatch query_batch(std::span<const AppearanceQuery> queries) {
  QueryBatch batch;
  if (queries.size() == batch_lanes) {
    spread(queries.data(), batch);
  } else {
    Batch<AppearanceQuery> filled;
    for (std::size_t i = 0; i < batch_lanes; ++i)
      filled[i] = queries[std::min(i, queries.size() - 1)];
    spread(filled.data(), batch);
  }
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const bool seen = (batch.light.z[i] > 0) & (batch.view.z[i] > 0);
    batch.is_seen[i] = seen;
    for (DirectionLanes* d : {&batch.light, &batch.view}) {
      d->x[i] = seen ? d->x[i] : 0;
      d->y[i] = seen ? d->y[i] : 0;
      d->z[i] = seen ? d->z[i] : 1;
    }
  }
  return batch;
}

LevelBatch level_batch(const Batch<float>& lod, std::size_t n_levels) {
  const auto last = static_cast<std::int32_t>(n_levels) - 1;
  LevelBatch level;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    // A NaN is level 0.
    const float asked = lod[i] > 0 ? std::min(lod[i], static_cast<float>(last)) : 0;
    level.fine[i] = static_cast<std::int32_t>(asked);
    level.coarse[i] = std::min(level.fine[i] + 1, last);
    level.blend[i] = asked - static_cast<float>(level.fine[i]);
  }
  return level;
}

AxisBatch column_batch(const Batch<float>& u, const Batch<std::int32_t>& size) {
  alignas(64) Batch<float> place;
  for (std::size_t i = 0; i < batch_lanes; ++i)
    place[i] = (u[i] - std::floor(u[i])) * static_cast<float>(size[i]) - 0.5F;
  return axis_batch(place, size);
}

AxisBatch row_batch(const Batch<float>& v, const Batch<std::int32_t>& size) {
  alignas(64) Batch<float> place;
  for (std::size_t i = 0; i < batch_lanes; ++i)
    place[i] = (1 - (v[i] - std::floor(v[i]))) * static_cast<float>(size[i]) - 0.5F;
  return axis_batch(place, size);
}

TexelBatch texel_batch(const AxisBatch& columns, const AxisBatch& rows,
                       const Batch<std::int32_t>& width) {
  TexelBatch texels;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const std::int32_t low = rows.low[i] * width[i];
    const std::int32_t high = rows.high[i] * width[i];
    const float a = columns.blend[i];
    const float b = rows.blend[i];
    texels.index[0][i] = low + columns.low[i];
    texels.index[1][i] = low + columns.high[i];
    texels.index[2][i] = high + columns.low[i];
    texels.index[3][i] = high + columns.high[i];
    texels.weight[0][i] = (1 - a) * (1 - b);
    texels.weight[1][i] = a * (1 - b);
    texels.weight[2][i] = (1 - a) * b;
    texels.weight[3][i] = a * b;
  }
  return texels;
}

TexelBatch texel_batch(const QueryBatch& queries, int width, int height) {
  Batch<std::int32_t> columns;
  Batch<std::int32_t> rows;
  columns.fill(width);
  rows.fill(height);
  return texel_batch(column_batch(queries.u, columns), row_batch(queries.v, rows), columns);
}

Batch<PairLane> pair_batch(const StencilBatch& views, const StencilBatch& lights,
                           std::span<const float> of_light, const Batch<float>& factor) {
  Batch<PairLane> pairs;
  for (std::size_t i = 0; i < batch_lanes; ++i)
    set_pairs(views[i], lights[i], of_light, factor[i], pairs[i]);
  return pairs;
}

PairLane pair_lane(const Stencil& views, const Stencil& lights, std::span<const float> of_light,
                   float factor) {
  PairLane pairs;
  set_pairs(lane_of(views), lane_of(lights), of_light, factor, pairs);
  return pairs;
}

}  // namespace weft
