#include "codecs/cmf/half_link.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace weft::cmf {

using factor_maps::add_scaled;
using factor_maps::BilinearTaps;
using factor_maps::lane_count;

namespace {

// Less than any reflectance: half's least positive value is 6e-8.
constexpr float darkest = 1e-30F;

// Least Q, as a share of its map's largest. The same for 8 bits as for float, so that both fit and
// cluster alike.
constexpr float floor_share = 1e-4F;

Lanes looked_up(const Lanes* map, const BilinearTaps& taps) {
  Lanes value;
  for (std::size_t t = 0; t < 4; ++t) add_scaled(value, taps.weight[t], map[taps.index[t]]);
  return value;
}

Lanes ones() {
  Lanes one;
  std::fill_n(one.lane, lane_count, 1.0F);
  return one;
}

// Binomial weights 1 2 1 along rows (stride 1) or columns (stride `resolution`), nothing beyond.
void blur(int resolution, int stride, LaneVector& sums) {
  const LaneVector before = sums;
  for (int t = 0; t < static_cast<int>(sums.size()); ++t) {
    const int along = t / stride % resolution;
    for (int k = 0; k < lane_count; ++k) {
      const float left = along > 0 ? before[t - stride][k] : 0.0F;
      const float right = along + 1 < resolution ? before[t + stride][k] : 0.0F;
      sums[t][k] = 0.5F * before[t][k] + 0.25F * (left + right);
    }
  }
}

// Two sums over the pairs that ask for a texel: L^T top and L^T bottom, L being what looks it up.
struct Update {
  LaneVector wanted;
  LaneVector present;

  explicit Update(std::size_t texels) : wanted(texels), present(texels) {}

  void add(const BilinearTaps& taps, const Lanes& top, const Lanes& bottom) {
    for (std::size_t t = 0; t < 4; ++t) {
      add_scaled(wanted[taps.index[t]], taps.weight[t], top);
      add_scaled(present[taps.index[t]], taps.weight[t], bottom);
    }
  }
  /// Few pairs leave texels between them unasked, and what is asked follows the noise of one pair:
  /// each texel is given its neighbours' sums too, by binomial weights, `passes` times.
  void spread(int resolution, int passes) {
    for (int pass = 0; pass < passes; ++pass) {
      for (LaneVector* sums : {&wanted, &present}) {
        blur(resolution, 1, *sums);
        blur(resolution, resolution, *sums);
      }
    }
  }
  void multiply(Lanes* map) const {
    for (std::size_t t = 0; t < wanted.size(); ++t) {
      for (int k = 0; k < lane_count; ++k) {
        if (present[t][k] > 0) map[t][k] *= wanted[t][k] / present[t][k];
      }
    }
  }
  LaneVector ratio() const {
    LaneVector result(wanted.size());
    for (std::size_t t = 0; t < wanted.size(); ++t) {
      for (int k = 0; k < lane_count; ++k) {
        result[t][k] = present[t][k] > 0 ? wanted[t][k] / present[t][k] : 0.0F;
      }
    }
    return result;
  }
};

// How far to go along `step` for the least sum of w (left - slope L step)^2: sums in double.
Lanes best_length(const LaneVector& step, const std::vector<BilinearTaps>& lookup,
                  const LaneVector& left, const LaneVector& slope,
                  std::span<const double> weights) {
  factor_maps::DoubleLanes top;
  factor_maps::DoubleLanes bottom;
  const std::size_t pairs_a_light = left.size() / weights.size();
  for (std::size_t pair = 0; pair < left.size(); ++pair) {
    const Lanes along = looked_up(step.data(), lookup[pair]);
    const double w = weights[pair / pairs_a_light];
    for (int k = 0; k < lane_count; ++k) {
      const double change = static_cast<double>(slope[pair][k]) * along[k];
      top[k] += w * left[pair][k] * change;
      bottom[k] += w * change * change;
    }
  }
  Lanes length;
  for (int k = 0; k < lane_count; ++k) {
    length[k] = bottom[k] > 0 ? static_cast<float>(top[k] / bottom[k]) : 0.0F;
  }
  return length;
}

// None where each texel of the disc is one of some pair's four.
int spread_passes(std::size_t pairs, const factor_maps::ParabolicMap& map) {
  const double disc = std::numbers::pi / 4 * map.texels();
  return static_cast<int>(std::min(4 * disc / static_cast<double>(pairs), 64.0));
}

}  // namespace

HalfLink::HalfLink(const HemisphereSampling& lights, const HemisphereSampling& views,
                   const factor_maps::ParabolicMap& map, int rings, bool with_difference, int terms)
    : terms_(terms),
      with_difference_(with_difference),
      map_(map),
      spread_(spread_passes(lights.size() * views.size(), map)),
      average_(factor_maps::half_average(lights, views, map, rings)),
      half_lookup_(factor_maps::half_lookup(lights, views, map)) {
  if (with_difference) difference_lookup_ = factor_maps::difference_lookup(lights, views, map);
}

HalfMaps HalfLink::start(const LaneVector& f) const {
  LaneVector map = factor_maps::multiply(average_, f);
  Lanes largest;
  for (const Lanes& texel : map) {
    for (int k = 0; k < lane_count; ++k) largest[k] = std::max(largest[k], texel[k]);
  }
  for (Lanes& texel : map) {
    for (int k = 0; k < lane_count; ++k) {
      texel[k] = largest[k] > darkest ? std::max(texel[k], floor_share * largest[k]) : 1.0F;
    }
  }
  if (!with_difference_) return {std::move(map), {}};
  HalfMaps maps;
  for (int term = 0; term < terms_; ++term) {
    maps.half.insert(maps.half.end(), map.begin(), map.end());
    for (int texel = 0; texel < map_.texels(); ++texel) {
      Lanes value = ones();
      const float power = std::pow(map_.direction(texel).z, 2.0F * static_cast<float>(term));
      for (int k = 0; k < lane_count; ++k) value[k] = power / static_cast<float>(terms_);
      maps.difference.push_back(value);
    }
  }
  return maps;
}

LaneVector HalfLink::values(const HalfMaps& maps) const {
  LaneVector values = signed_sum(maps);
  for (Lanes& value : values) {
    for (int k = 0; k < lane_count; ++k) value[k] = std::max(value[k], 0.0F);
  }
  return values;
}

LaneVector HalfLink::signed_sum(const HalfMaps& maps) const {
  if (!with_difference_) return factor_maps::looked_up(maps.half, half_lookup_);
  LaneVector values(half_lookup_.size());
  const auto texels = static_cast<std::size_t>(map_.texels());
  for (int term = 0; term < terms_; ++term) {
    for (std::size_t pair = 0; pair < values.size(); ++pair) {
      const Lanes q = looked_up(&maps.half[term * texels], half_lookup_[pair]);
      const Lanes d = looked_up(&maps.difference[term * texels], difference_lookup_[pair]);
      for (int k = 0; k < lane_count; ++k) values[pair][k] += q[k] * d[k];
    }
  }
  return values;
}

void HalfLink::update(const LaneVector& f, const LaneVector& others,
                      std::span<const double> light_weights, Sign sign, HalfMaps& maps) const {
  for (const bool of_half : {true, false}) {
    if (!of_half && !with_difference_) break;
    for (int term = 0; term < (with_difference_ ? terms_ : 1); ++term) {
      update_map(f, others, light_weights, sign, of_half, term, maps);
    }
  }
}

void HalfLink::update_map(const LaneVector& f, const LaneVector& others,
                          std::span<const double> light_weights, Sign sign, bool of_half, int term,
                          HalfMaps& maps) const {
  const std::size_t first = static_cast<std::size_t>(term) * map_.texels();
  const LaneVector& held = of_half ? maps.difference : maps.half;
  const auto& lookup = of_half ? half_lookup_ : difference_lookup_;
  const auto& held_lookup = of_half ? difference_lookup_ : half_lookup_;
  Lanes* solved = of_half ? &maps.half[first] : &maps.difference[first];
  const std::size_t n_views = f.size() / light_weights.size();
  LaneVector left = signed_sum(maps);
  Update update(map_.texels());
  const bool any = sign == Sign::any;
  LaneVector slopes(any ? f.size() : 0);
  for (std::size_t pair = 0; pair < f.size(); ++pair) {
    const auto w = static_cast<float>(light_weights[pair / n_views]);
    const Lanes y = with_difference_ ? looked_up(&held[first], held_lookup[pair]) : ones();
    Lanes top;
    Lanes bottom;
    for (int k = 0; k < lane_count; ++k) {
      const float slope = others[pair][k] * y[k];
      const float is = others[pair][k] * left[pair][k];
      if (any) slopes[pair][k] = slope;
      left[pair][k] = f[pair][k] - is;
      top[k] = w * slope * (any ? left[pair][k] : f[pair][k]);
      bottom[k] = w * slope * (any ? slope : is);
    }
    update.add(lookup[pair], top, bottom);
  }
  update.spread(map_.resolution(), spread_);
  if (!any) {
    update.multiply(solved);
    return;
  }
  const LaneVector step = update.ratio();
  const Lanes length = best_length(step, lookup, left, slopes, light_weights);
  for (std::size_t t = 0; t < step.size(); ++t) {
    for (int k = 0; k < lane_count; ++k) solved[t][k] += length[k] * step[t][k];
  }
}

}  // namespace weft::cmf
