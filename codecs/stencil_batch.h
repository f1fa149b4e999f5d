// HemisphereSampling::locate for sixteen directions at once, for batched decoding.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "btf/appearance.h"
#include "btf/hemisphere_sampling.h"

namespace weft {

constexpr int batch_lanes = 16;

/// Three neighbours of sixteen directions and their weights, [neighbour][lane].
struct StencilBatch {
  alignas(64) std::array<std::array<std::int32_t, batch_lanes>, 3> index;
  alignas(64) std::array<std::array<float, batch_lanes>, 3> weight;

  Stencil lane(std::size_t i) const {
    Stencil stencil;
    for (std::size_t k = 0; k < 3; ++k) {
      stencil.index[k] = static_cast<std::uint16_t>(index[k][i]);
      stencil.weight[k] = weight[k][i];
    }
    return stencil;
  }
};

/// Where the triangle that the grid names holds the direction, the weights are affine functions of
/// its parabolic image, looked up side by side; the rest, a walk or beyond the hull, is asked one
/// by one. The same stencils as `locate`'s but for rounding.
class BatchLocator {
 public:
  explicit BatchLocator(const HemisphereSampling& sampling);

  /// @param sampling    that it was made of.
  /// @param directions  sixteen unit vectors, z >= 0.
  StencilBatch locate(const HemisphereSampling& sampling,
                      const std::array<Direction, batch_lanes>& directions) const;

 private:
  std::vector<std::array<float, 9>> weights_;  // a triangle: of x, of y, constant, for each corner
};

/// Answers queries sixteen stencils at a time: `decode(query, views, lights)` where light and view
/// are above the horizon, 0 elsewhere.
template <typename Decode>
void decode_in_batches(const HemisphereSampling& views, const BatchLocator& view_locator,
                       const HemisphereSampling& lights, const BatchLocator& light_locator,
                       std::span<const AppearanceQuery> queries, std::span<Rgb> answers,
                       const Decode& decode) {
  const auto is_seen = [](const AppearanceQuery& q) { return q.light.z > 0 && q.view.z > 0; };
  for (std::size_t first = 0; first < queries.size(); first += batch_lanes) {
    const std::size_t count = std::min<std::size_t>(batch_lanes, queries.size() - first);
    std::array<Direction, batch_lanes> light;
    std::array<Direction, batch_lanes> view;
    for (std::size_t i = 0; i < batch_lanes; ++i) {
      const AppearanceQuery& query = queries[first + std::min(i, count - 1)];
      light[i] = is_seen(query) ? query.light : Direction(0, 0, 1);
      view[i] = is_seen(query) ? query.view : Direction(0, 0, 1);
    }
    const StencilBatch by_view = view_locator.locate(views, view);
    const StencilBatch by_light = light_locator.locate(lights, light);
    for (std::size_t i = 0; i < count; ++i) {
      const AppearanceQuery& query = queries[first + i];
      answers[first + i] =
          is_seen(query) ? decode(query, by_view.lane(i), by_light.lane(i)) : Rgb(0, 0, 0);
    }
  }
}

}  // namespace weft
