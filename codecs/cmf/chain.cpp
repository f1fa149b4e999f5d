#include "codecs/cmf/chain.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace weft::cmf {

using factor_maps::ParabolicMap;
using factor_maps::Projection;

namespace {

// After 3 rounds the error is within 0.1 % of where 60 lead, on rendered BTFs.
constexpr int weighted_rounds = 10;

// Of Q and D alone, before light and view are solved.
constexpr int half_rounds = 5;

// Least divisor of a residual, as a share of the largest.
constexpr float divisor_share = 1e-4F;

// How many times its largest value at the start a factor may reach while it is refined. Without a
// bound, factors of a few glossy texels grow to 1e7 where the others vanish: nothing is gained, and
// 8 bits, whose steps are of the largest scale, lose all other texels. A bound of 2 costs less than
// 1 % of the error.
constexpr float growth = 2;

LaneVector ones(std::size_t count) {
  Lanes one;
  std::fill_n(one.lane, lane_count, 1.0F);
  return LaneVector(count, one);
}

Lanes largest(const LaneVector& values) {
  Lanes result;
  for (const Lanes& value : values) {
    for (int k = 0; k < lane_count; ++k) result[k] = std::max(result[k], std::abs(value[k]));
  }
  return result;
}

void bound(const Lanes& start, LaneVector& values) {
  for (Lanes& value : values) {
    for (int k = 0; k < lane_count; ++k)
      value[k] = std::clamp(value[k], -growth * start[k], growth * start[k]);
  }
}

// Equation 7, by a divisor that is nowhere zero: 0 only where all of it is.
LaneVector residual(const LaneVector& f, const LaneVector& divisor) {
  const Lanes top = largest(divisor);
  LaneVector result(f.size());
  for (std::size_t pair = 0; pair < f.size(); ++pair) {
    for (int k = 0; k < lane_count; ++k) {
      const float by = std::max(divisor[pair][k], divisor_share * top[k]);
      result[pair][k] = by > 0 ? f[pair][k] / by : 0.0F;
    }
  }
  return result;
}

}  // namespace

Chain::Chain(const HemisphereSampling& lights, const HemisphereSampling& views,
             const ChainOptions& options)
    : n_lights_(lights.size()),
      n_views_(views.size()),
      options_(options),
      light_map_(lights, ParabolicMap(options.resolution)),
      view_map_(views, ParabolicMap(options.resolution)) {
  if (options.half) {
    half_link_.emplace(lights, views, ParabolicMap(options.resolution), options.difference_rings,
                       options.difference, options.difference ? options.terms : 1);
  }
  for (const Direction& light : lights.directions()) {
    const double cosine = std::max(light.z, 1e-6F);
    light_weights_.push_back(cosine * cosine);
  }
}

std::vector<FactorMaps> Chain::factorise(const LaneVector& f) const {
  LightView factors;
  HalfMaps half;
  if (!half_link_) {
    factors = light_and_view(f, ones(f.size()));
  } else {
    LaneVector others = ones(f.size());
    if (options_.order == Order::half_last) {
      factors = light_and_view(f, others);
      others = sum_of_terms(factors, n_lights_, n_views_);
    }
    half = half_link_->start(options_.order == Order::half_last ? residual(f, others) : f);
    for (int round = 0; options_.difference && round < half_rounds; ++round) {
      half_link_->update(f, others, light_weights_, Sign::non_negative, half);
    }
    if (options_.order == Order::half_first) factors = light_and_view(f, half_link_->values(half));
    refine(f, factors, half);
  }
  if (options_.terms > 1) balance_terms(factors, n_lights_, n_views_);
  std::vector<FactorMaps> maps;
  maps.push_back({Projection::light, maps_of(light_map_, factors.light)});
  if (options_.half) maps.push_back({Projection::half, std::move(half.half)});
  if (options_.difference) maps.push_back({Projection::difference, std::move(half.difference)});
  maps.push_back({Projection::view, maps_of(view_map_, factors.view)});
  return maps;
}

LightView Chain::light_and_view(const LaneVector& f, const LaneVector& q) const {
  const LaneVector left = residual(f, q);
  LightView first = rank_one(left, n_lights_, n_views_);
  if (options_.rank_one == RankOne::plain) {
    if (options_.terms == 1) return first;
    return weighted_low_rank(left, ones(f.size()), std::vector<double>(n_lights_, 1.0),
                             options_.terms, options_.sign, weighted_rounds, std::move(first));
  }
  first = weighted_rank_one(f, q, light_weights_, weighted_rounds, std::move(first));
  if (options_.terms == 1) return first;
  return weighted_low_rank(f, q, light_weights_, options_.terms, options_.sign, weighted_rounds,
                           std::move(first));
}

// Lowers sum over pairs of w_light (f - product of links)^2: each link in turn with the other held.
// But for the bound on growth no step raises it where terms are not below zero. Of several terms of
// any sign those over half and difference begin above zero, whose updates get further in as many
// rounds, and as many rounds follow in which they may fall below it.
void Chain::refine(const LaneVector& f, LightView& factors, HalfMaps& half) const {
  const Lanes start_light = largest(factors.light);
  const Lanes start_view = largest(factors.view);
  const Lanes start_half = largest(half.half);
  const Lanes start_difference = largest(half.difference);
  const bool falls = options_.difference && options_.terms > 1 && options_.sign == Sign::any;
  for (int round = 0; round < (falls ? 2 : 1) * options_.refine; ++round) {
    half_link_->update(f, sum_of_terms(factors, n_lights_, n_views_), light_weights_,
                       round < options_.refine ? Sign::non_negative : Sign::any, half);
    bound(start_half, half.half);
    bound(start_difference, half.difference);
    factors = weighted_low_rank(f, half_link_->values(half), light_weights_, options_.terms,
                                options_.sign, 1, std::move(factors));
    bound(start_light, factors.light);
    bound(start_view, factors.view);
  }
}

// A map a term. What may be below zero is the difference of two maps that are not.
LaneVector Chain::maps_of(const factor_maps::SampleMap& maker, const LaneVector& samples) const {
  const std::size_t count = maker.taps().size();
  LaneVector maps;
  for (std::size_t first = 0; first < samples.size(); first += count) {
    LaneVector above(count);
    LaneVector below(count);
    for (std::size_t i = 0; i < count; ++i) {
      for (int k = 0; k < lane_count; ++k) {
        above[i][k] = std::max(samples[first + i][k], 0.0F);
        below[i][k] = std::max(-samples[first + i][k], 0.0F);
      }
    }
    LaneVector map = maker.map_of(above);
    if (options_.terms > 1 && options_.sign == Sign::any) {
      const LaneVector negative = maker.map_of(below);
      for (std::size_t t = 0; t < map.size(); ++t) {
        for (int k = 0; k < lane_count; ++k) map[t][k] -= negative[t][k];
      }
    }
    maps.insert(maps.end(), map.begin(), map.end());
  }
  return maps;
}

}  // namespace weft::cmf
