// The virtual gonioreflectometer: one view of a mesostructure under every light at once.
//
// A path from the eye does not depend on the light, so each path is traced once a (texel, sample)
// and every vertex is connected to every light. The estimate of one pair is unbiased; the noise of
// one view's lights is correlated.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "acquisition/facets.h"
#include "acquisition/indirect_cache.h"
#include "acquisition/light_set.h"
#include "acquisition/mesostructure.h"
#include "acquisition/periodic_scene.h"
#include "acquisition/visibility_table.h"

namespace weft {

struct TraceSettings {
  static constexpr int unlimited = std::numeric_limits<int>::max();

  int width = 64;  ///< texels
  int height = 64;
  int spp = 64;         ///< eye paths a (view, texel)
  int max_bounces = 8;  ///< reflections after the first, to 4,096; 0 is direct light
  /// How many views are to be traced, on which it depends whether a visibility table pays.
  std::size_t views = 1;
  /// Without it every visibility query is traced.
  bool table = true;
  /// Takes what Lambert surfaces reflect of indirect light from a cache that all views share.
  /// Biased: see `IndirectCache`.
  bool indirect_cache = false;
  /// Where > 0, a texel of a view gets samples, at least 16 and at most `spp`, until the root mean
  /// square over lights of its standard error / max(m, 1e-3 of the largest m) is below; m is the
  /// tile's mean for that light, as a few other samples tell, and all is of the mean of RGB.
  /// Stopping on what the samples say is biased by a part of that error.
  double error = 0;
  bool texel_errors = false;             ///< also the standard error of every value
  std::optional<float> cut_height = {};  ///< also the share of each texel's rays that hit above it
  std::uint64_t seed = 0;
};

/// Where paths end, in every estimator: a path of a closed, white inside (a ray that slipped
/// between touching surfaces) would never end by itself, and those dimmer than `dim` are ended by
/// Russian roulette, which only unlimited bounces need.
struct PathEnd {
  static constexpr int most_bounces = 4096;
  static constexpr float dim = 0.02F;
};

/// What tracing cost, and what it met.
struct TraceStatistics {
  std::int64_t texels = 0;  ///< of views
  std::int64_t paths = 0;
  std::int64_t primary_rays = 0;
  std::int64_t bounce_rays = 0;
  /// Bounces, not of the cache's paths, that the table is certain would meet nothing.
  std::int64_t open_bounces = 0;
  std::int64_t open_checked = 0;  ///< of those, the traced ones
  std::int64_t open_wrong = 0;    ///< of these, those that did meet something
  std::int64_t shadow_rays = 0;
  std::int64_t table_rays = 0;          ///< that made the visibility table, once a dataset
  std::int64_t cache_rays = 0;          ///< that made the cache of indirect light, once a dataset
  std::int64_t visibility_queries = 0;  ///< asked by the estimator: traced, or answered by a table
  std::int64_t answers_checked = 0;     ///< certain answers that were traced all the same
  std::int64_t wrong_answers = 0;       ///< of those
  /// Means (texel, light, channel) that the correction of a wrong answer left below zero: stored as
  /// 0.
  std::int64_t negative = 0;
  std::int64_t rays_traced_on = 0;  ///< single rays for what left the copies of the tile
  std::int64_t missed = 0;          ///< paths whose first ray met nothing
  std::int64_t trapped =
      0;  ///< paths ended after 4,096 bounces: inside a closed surface, most likely
  std::int64_t invalid =
      0;  ///< directions drawn with a density that is not a number, where a path ends
  std::int64_t degenerate = 0;  ///< hits on triangles without an area, where a path ends
  std::int64_t unsettled = 0;  ///< texels of views that had all samples and missed the target error

  std::int64_t rays() const {
    return primary_rays + bounce_rays + shadow_rays + table_rays + cache_rays + rays_traced_on;
  }
  TraceStatistics& operator+=(const TraceStatistics& other);
};

struct TracedView {
  std::vector<float> values;  ///< [light][y][x][rgb], B in 1/sr
  /// Standard error of each light's tile mean (mean of RGB), from the spread of groups of samples;
  /// conservative, as stratification between groups is not credited. Empty with fewer than two
  /// samples.
  std::vector<float> standard_errors;
  std::vector<float> texel_errors;  ///< as `values`; empty where not asked for
  std::vector<float> coverage;      ///< [y][x], 0 to 1; empty where not asked for
  TraceStatistics statistics;
};

/// A mesostructure made ready for rays.
struct TraceableStructure {
  explicit TraceableStructure(Mesostructure structure);
  Mesostructure mesostructure;
  PeriodicScene scene;
  std::vector<Facet> facets;
};

class ViewTracer {
 public:
  /// @param lights  unit vectors, at most 89.9 degrees from the normal. @throws Error naming one
  /// that is not.
  ViewTracer(std::shared_ptr<const TraceableStructure> structure, std::vector<Direction> lights,
             TraceSettings settings);
  ViewTracer(Mesostructure mesostructure, std::vector<Direction> lights, TraceSettings settings);

  /// Traces one view with all of TBB's threads. `view_key` names the view in the random numbers.
  /// The same bytes for any number of threads. @throws Error  for a view below 89.9 degrees.
  TracedView trace(const Direction& view, std::uint64_t view_key) const;

  const LightSet& lights() const { return lights_; }
  const TraceSettings& settings() const { return settings_; }
  const Mesostructure& mesostructure() const { return structure_->mesostructure; }
  const PeriodicScene& scene() const { return structure_->scene; }
  const std::vector<Facet>& facets() const { return structure_->facets; }
  const VisibilityTable& visibility() const { return visibility_; }
  const IndirectCache& indirect_cache() const { return indirect_cache_; }

 private:
  std::vector<double> error_scales(const std::vector<float>& values) const;
  TracedView trace_blocks(const Direction& view, std::uint64_t view_key, int spp,
                          const std::vector<double>& error_scales) const;

  std::shared_ptr<const TraceableStructure> structure_;
  LightSet lights_;
  TraceSettings settings_;
  VisibilityTable visibility_;
  IndirectCache indirect_cache_;
};

/// @throws Error  where a direction is more than 89.9 degrees from the normal; `role` is "light" or
/// "view".
void check_elevations(std::span<const Direction> directions, const std::string& role);

}  // namespace weft
