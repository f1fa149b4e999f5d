// What each part of the surface sees of each light, as far as a few rays can tell.
//
// Big facets are cut into cells. Of each cell a few points look towards each light; where they and
// the cells around agree, the answer is nearly certain, and a path that meets the cell need not
// trace. More points are asked until hardly any of them contradicts what was certain before. The
// few answers that are wrong still are made good by `PathBlock`, which checks one in 256.
#pragma once

#include <cstdint>
#include <vector>

#include "acquisition/facets.h"
#include "acquisition/light_set.h"
#include "acquisition/periodic_scene.h"

namespace weft {

class VisibilityTable {
 public:
  /// For one cell and sixteen lights, a bit each.
  struct Answer {
    std::uint16_t known = 0;    ///< lights that nearly certainly are seen, or are not
    std::uint16_t visible = 0;  ///< of those, the seen ones
  };

  /// Knows nothing: every query is traced.
  VisibilityTable(const std::vector<Facet>& facets, const LightSet& lights);
  static constexpr int least_rays = 2;  ///< of each cell towards each light
  /// @param most_rays  of each cell towards each light, at least `least_rays`.
  VisibilityTable(const std::vector<Facet>& facets, const LightSet& lights,
                  const PeriodicScene& scene, int most_rays);

  /// How many cells a table would have.
  static std::size_t cells_of(const std::vector<Facet>& facets);

  /// One answer a group of lights, for a point of a facet seen from its normal's side.
  const Answer* at(std::uint32_t facet, float u, float v) const {
    return &answers_[cell(facet, u, v) * groups_];
  }
  /// On the other side nothing is known.
  const Answer* unknown() const { return &answers_[answers_.size() - groups_]; }

  /// What asking took.
  std::int64_t rays() const { return rays_; }
  /// Share of the last rays that contradicted what was certain before them.
  double contradicted() const { return contradicted_; }
  std::size_t bytes() const;

 private:
  struct Cells {
    std::uint32_t first = 0;
    std::uint16_t side = 1;  // cells a side: side * side in all
  };
  std::size_t cell(std::uint32_t facet, float u, float v) const;

  std::size_t groups_;
  std::vector<Cells> cells_;     // a facet
  std::vector<Answer> answers_;  // [cell][group]; the last row knows nothing
  std::int64_t rays_ = 0;
  double contradicted_ = 0;
};

}  // namespace weft
