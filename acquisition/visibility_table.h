// What each part of the surface sees of each light, as far as a few rays can tell.
//
// Big facets are cut into cells. Of each cell a few points look towards each light; where they and
// the cells around agree, the answer is nearly certain, and a path that meets the cell need not
// trace. More points are asked, mostly next to what is uncertain, until hardly any of them
// contradicts what was certain before. Cells that stay uncertain of some light, mostly where a
// shadow ends, are cut finer and asked again. The few answers that are wrong still are made good by
// `PathBlock`, which checks one in 256.
//
// It answers for rays between the lights, too: from where all lights around a direction are seen,
// a ray that way most likely meets nothing. `PathBlock` checks one in four of these, or, where a
// trial of such rays met nothing at all, one in sixteen.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "acquisition/surrounding_lights.h"
#include "acquisition/visibility_inquiry.h"

namespace weft {

class VisibilityTable {
 public:
  using Answer = VisibilityAnswer;

  /// Knows nothing: every query is traced.
  explicit VisibilityTable(const LightSet& lights);
  /// Of each cell towards each light; with fewer a table is worth nothing.
  static constexpr int least_rays = 2;
  /// From so many rays a cell and light on, uncertain cells are cut into 16 and asked again.
  static constexpr int rays_to_refine = 32;
  /// @param cells      of the facets.
  /// @param most_rays  of each cell towards each light, at least `least_rays`.
  VisibilityTable(const std::vector<Facet>& facets, FacetCells cells, const LightSet& lights,
                  const PeriodicScene& scene, int most_rays);

  /// One answer a group of lights, for a point of a facet seen from its normal's side. Of facets
  /// that the table does not have nothing is known.
  const Answer* at(std::uint32_t facet, float u, float v) const {
    if (facet >= cells_.facets()) return unknown();
    Barycentric place{u, v};
    const Rows& rows = rows_[cells_.find(facet, place)];
    const std::size_t row = rows.first + (rows.refined ? enter(refinement, place) : 0);
    return &answers_[row * groups_];
  }
  /// On the other side nothing is known.
  const Answer* unknown() const { return &answers_[answers_.size() - groups_]; }

  /// Whether a ray of this direction from a place with these answers is nearly certain to meet
  /// nothing, as all lights around the direction are seen.
  bool is_open(const Answer* answers, const Direction& direction) const {
    const std::span<const SurroundingLights::Part> around = surrounding_.around(direction);
    for (const auto& [group, lights] : around) {
      if ((lights & ~answers[group].visible) != 0) return false;
    }
    return !around.empty();
  }
  /// Of the rays that `is_open` tells of, one in so many is to be traced. What it meets after all
  /// counts so many times, which adds noise where that is not very rare: there, more are traced.
  std::uint32_t open_check_every() const { return open_check_every_; }

  /// What asking took.
  std::int64_t rays() const { return rays_; }

 private:
  static constexpr int refinement = 4;  // cells a side that a cell is cut into
  static constexpr std::size_t parts = std::size_t{refinement} * refinement;

  struct Rows {
    std::uint32_t first : 31 = 0;
    std::uint32_t refined : 1 = 0;  // then `parts` rows, in the order of `enter`
  };

  // Asks round after round, at most `most_rays`, until hardly any answer is contradicted; `share`
  // is the share of all queries that what is asked stands for.
  void ask(VisibilityInquiry& inquiry, int most_rays, double share, std::vector<Answer>& answers);
  // Lays the answers of cells that are not cut finer, and of the parts of those that are.
  void lay(const std::vector<Answer>& answers, std::span<const std::uint32_t> cut_cells,
           const std::vector<Answer>& fine_answers);
  // Decides how often rays that are open are traced.
  void try_open(const std::vector<Facet>& facets, const PeriodicScene& scene);

  std::size_t groups_;
  SurroundingLights surrounding_;
  FacetCells cells_;
  std::vector<Rows> rows_;       // a cell
  std::vector<Answer> answers_;  // [row][group]; the last row knows nothing
  std::uint32_t open_check_every_ = 1;
  std::int64_t rays_ = 0;
};

}  // namespace weft
