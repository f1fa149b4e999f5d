// What each cell of a Lambert surface reflects of the light that comes by way of other surfaces.
//
// A Lambert surface looks the same from everywhere, so what it reflects indirectly can be traced
// once a cell and light, and serve every view. That is biased: within a cell it is constant, and
// all views share its noise.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/facet_cells.h"
#include "tracer/lanes.h"

namespace weft {

class ViewTracer;
struct Mesostructure;

class IndirectCache {
 public:
  /// Knows nothing.
  IndirectCache() = default;
  /// Traces from all cells together four times the paths of a view, at least four from each, and
  /// as far as the tracer's settings say. @throws Error  where a material is not Lambert, the
  /// structure has fibres, or the cache would take over 1 GB.
  explicit IndirectCache(const ViewTracer& tracer);

  /// What about a structure makes a cache impossible; nothing where it is possible.
  static std::optional<std::string> obstacle(const Mesostructure& mesostructure);

  bool empty() const { return values_.empty(); }
  /// One a group of lights: B, in 1/sr, of indirect light alone, for a point of a facet seen from
  /// its normal's side.
  const RgbLanes* at(std::uint32_t facet, float u, float v) const {
    Barycentric place{u, v};
    return &values_[cells_.find(facet, place) * groups_];
  }
  std::int64_t rays() const { return rays_; }

 private:
  std::size_t groups_ = 0;
  FacetCells cells_;
  std::vector<RgbLanes> values_;  // [cell][group]
  std::int64_t rays_ = 0;
};

}  // namespace weft
