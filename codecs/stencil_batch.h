// Where sixteen queries stand, found side by side for batched decoding: their four texels, and
// their three views and three lights.
#pragma once

#include <oneapi/tbb/cache_aligned_allocator.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "btf/appearance.h"
#include "btf/hemisphere_sampling.h"
#include "btf/raw_appearance.h"
#include "codecs/batch_locator.h"

namespace weft {

/// Rows of numbers that begin at the beginning of a cache line.
using AlignedFloats = std::vector<float, oneapi::tbb::cache_aligned_allocator<float>>;

struct QueryBatch {
  alignas(64) Batch<float> u;
  alignas(64) Batch<float> v;
  alignas(64) Batch<float> lod;
  DirectionLanes light;
  DirectionLanes view;
  Batch<bool> is_seen;  ///< light and view are above the horizon; where not, they are the normal
};

/// @param queries  one to sixteen; the last one fills the lanes beyond.
QueryBatch query_batch(std::span<const AppearanceQuery> queries);

/// Level of detail = fine + blend, of levels 0 to n - 1; `coarse` is the next one, or the last.
struct LevelBatch {
  alignas(64) Batch<std::int32_t> fine;
  alignas(64) Batch<std::int32_t> coarse;
  alignas(64) Batch<float> blend;
};
LevelBatch level_batch(const Batch<float>& lod, std::size_t n_levels);

/// The twin of `AxisStencil`.
struct AxisBatch {
  alignas(64) Batch<std::int32_t> low;
  alignas(64) Batch<std::int32_t> high;
  alignas(64) Batch<float> blend;
};
/// Of `size` columns, or rows.
AxisBatch column_batch(const Batch<float>& u, const Batch<std::int32_t>& size);
AxisBatch row_batch(const Batch<float>& v, const Batch<std::int32_t>& size);

/// The twin of `TexelStencil`, [texel][lane].
struct TexelBatch {
  alignas(64) std::array<Batch<std::int32_t>, 4> index;
  alignas(64) std::array<Batch<float>, 4> weight;

  TexelStencil lane(std::size_t i) const {
    TexelStencil texels;
    for (std::size_t t = 0; t < 4; ++t) {
      texels.index[t] = static_cast<std::uint32_t>(index[t][i]);
      texels.weight[t] = weight[t][i];
    }
    return texels;
  }
};
TexelBatch texel_batch(const AxisBatch& columns, const AxisBatch& rows,
                       const Batch<std::int32_t>& width);
TexelBatch texel_batch(const QueryBatch& queries, int width, int height);

/// Texels of each lane's level, of which most batches have one.
/// @param size_of  (level) to its width and height.
template <typename SizeOf>
TexelBatch level_texel_batch(const QueryBatch& queries, const Batch<std::int32_t>& levels,
                             const SizeOf& size_of) {
  if (std::ranges::all_of(levels, [&](std::int32_t l) { return l == levels[0]; })) {
    const auto [width, height] = size_of(levels[0]);
    return texel_batch(queries, width, height);
  }
  Batch<std::int32_t> widths;
  Batch<std::int32_t> heights;
  for (std::size_t i = 0; i < batch_lanes; ++i)
    std::tie(widths[i], heights[i]) = size_of(levels[i]);
  return texel_batch(column_batch(queries.u, widths), row_batch(queries.v, heights), widths);
}

/// Views times lights; places 4 v + 3 weigh nothing, and the last of the views is none.
struct alignas(64) PairLane : SampleStencil {
  std::array<std::int32_t, 4> view;
};
/// @param of_light  what the weights of each light are multiplied by.
/// @param factor    what all of a lane's are multiplied by.
Batch<PairLane> pair_batch(const StencilBatch& views, const StencilBatch& lights,
                           std::span<const float> of_light, const Batch<float>& factor);
/// Of one query.
PairLane pair_lane(const Stencil& views, const Stencil& lights, std::span<const float> of_light,
                   float factor);

/// Answers queries sixteen at a time: `decode(batch)` of type `Batch<Rgb>(const QueryBatch&)`
/// where light and view are above the horizon, 0 elsewhere.
template <typename Decode>
void decode_in_batches(std::span<const AppearanceQuery> queries, std::span<Rgb> answers,
                       const Decode& decode) {
  for (std::size_t first = 0; first < queries.size(); first += batch_lanes) {
    const std::size_t count = std::min<std::size_t>(batch_lanes, queries.size() - first);
    const QueryBatch batch = query_batch(queries.subspan(first, count));
    const Batch<Rgb> values = decode(batch);
    for (std::size_t i = 0; i < count; ++i)
      answers[first + i] = batch.is_seen[i] ? values[i] : Rgb(0, 0, 0);
  }
}

}  // namespace weft
