#include "codecs/cmf/chain.h"

#include <algorithm>
#include <utility>

#include "codecs/cmf/refinement.h"

namespace weft::cmf {

Chain::Chain(const HemisphereSampling& lights, const HemisphereSampling& views,
             const ChainOptions& options)
    : n_lights_(lights.size()),
      n_views_(views.size()),
      options_(options),
      light_map_(lights, ParabolicMap(options.resolution)),
      view_map_(views, ParabolicMap(options.resolution)) {
  if (options.half) {
    const ParabolicMap map(options.resolution);
    average_ = half_average(lights, views, map, options.difference_rings);
    lookup_ = half_lookup(lights, views, map);
  }
  for (const Direction& light : lights.directions()) {
    const double cosine = std::max(light.z, 1e-6F);
    light_weights_.push_back(cosine * cosine);
  }
}

FactorMaps Chain::factorise(const LaneVector& f) const {
  if (!options_.half) {
    Lanes ones;
    std::fill_n(ones.lane, lane_count, 1.0F);
    const LightView factors = light_and_view(f, LaneVector(f.size(), ones));
    return {light_map_.map_of(factors.light), {}, view_map_.map_of(factors.view)};
  }
  LaneVector half = half_map(f);
  LightView factors = light_and_view(f, looked_up(half, lookup_));
  refine(f, lookup_, light_weights_, options_.refine, factors, half);
  return {light_map_.map_of(factors.light), std::move(half), view_map_.map_of(factors.view)};
}

// After 3 rounds the error is within 0.1 % of where 60 lead, on rendered BTFs.
constexpr int weighted_rounds = 10;

// Less than any reflectance: half's least positive value is 6e-8.
constexpr float darkest = 1e-30F;

// Least Q, as a share of its map's largest. The same for 8 bits as for float, so that both fit and
// cluster alike.
constexpr float floor_share = 1e-4F;

// P_h: F_hd averaged over its columns. Below `floor_share` of its largest value Q is raised: the
// residual (equation 7) stays bounded. A map of zeros becomes one of ones.
LaneVector Chain::half_map(const LaneVector& f) const {
  LaneVector map = multiply(average_, f);
  Lanes largest;
  for (const Lanes& texel : map) {
    for (int k = 0; k < lane_count; ++k) largest[k] = std::max(largest[k], texel[k]);
  }
  for (Lanes& texel : map) {
    for (int k = 0; k < lane_count; ++k) {
      texel[k] = largest[k] > darkest ? std::max(texel[k], floor_share * largest[k]) : 1.0F;
    }
  }
  return map;
}

// The rank-1 step on the residual of equation 7. The floor of Q makes every divisor positive.
LightView Chain::light_and_view(const LaneVector& f, const LaneVector& q) const {
  LaneVector residual(f.size());
  for (std::size_t pair = 0; pair < f.size(); ++pair) {
    for (int k = 0; k < lane_count; ++k) residual[pair][k] = f[pair][k] / q[pair][k];
  }
  LightView factors = rank_one(residual, n_lights_, n_views_);
  if (options_.rank_one == RankOne::plain) return factors;
  return weighted_rank_one(f, q, light_weights_, weighted_rounds, std::move(factors));
}

}  // namespace weft::cmf
