#include "codecs/cmf/refinement.h"

#include <algorithm>
#include <utility>

#include "codecs/cmf/half_difference.h"

namespace weft::cmf {

namespace {

// How many times its largest value at the start a factor may reach. Without a bound, factors of a
// few glossy texels grow to 1e7 where the others vanish: nothing is gained, and 8 bits, whose steps
// are of the largest scale, lose all other texels. A bound of 2 costs less than 1 % of the error.
constexpr float growth = 2;

Lanes largest(const LaneVector& factor) {
  Lanes result;
  for (const Lanes& value : factor) {
    for (int k = 0; k < lane_count; ++k) result[k] = std::max(result[k], value[k]);
  }
  return result;
}

void bound(LaneVector& factor, const Lanes& start) {
  for (Lanes& value : factor) {
    for (int k = 0; k < lane_count; ++k) value[k] = std::min(value[k], growth * start[k]);
  }
}

// Q_t *= (L^T w P R f)_t / (L^T w (P R)^2 L Q)_t, L the lookup.
void scale_half(const LaneVector& f, const LaneVector& q, std::span<const BilinearTaps> lookup,
                std::span<const double> light_weights, const LightView& factors, LaneVector& half) {
  const std::size_t n_views = factors.view.size();
  LaneVector wanted(half.size());
  LaneVector present(half.size());
  for (std::size_t i = 0; i < factors.light.size(); ++i) {
    const auto w = static_cast<float>(light_weights[i]);
    for (std::size_t j = 0; j < n_views; ++j) {
      const std::size_t pair = i * n_views + j;
      const BilinearTaps& taps = lookup[pair];
      Lanes top;
      Lanes bottom;
      for (int k = 0; k < lane_count; ++k) {
        const float pr = factors.light[i][k] * factors.view[j][k];
        top[k] = w * pr * f[pair][k];
        bottom[k] = w * pr * pr * q[pair][k];
      }
      for (std::size_t t = 0; t < 4; ++t) {
        add_scaled(wanted[taps.index[t]], taps.weight[t], top);
        add_scaled(present[taps.index[t]], taps.weight[t], bottom);
      }
    }
  }
  for (std::size_t t = 0; t < half.size(); ++t) {
    for (int k = 0; k < lane_count; ++k) {
      if (present[t][k] > 0) half[t][k] *= wanted[t][k] / present[t][k];
    }
  }
}

}  // namespace

void refine(const LaneVector& f, std::span<const BilinearTaps> lookup,
            std::span<const double> light_weights, int rounds, LightView& factors,
            LaneVector& half) {
  const Lanes start_half = largest(half);
  const Lanes start_light = largest(factors.light);
  const Lanes start_view = largest(factors.view);
  LaneVector q = looked_up(half, lookup);
  for (int round = 0; round < rounds; ++round) {
    scale_half(f, q, lookup, light_weights, factors, half);
    bound(half, start_half);
    q = looked_up(half, lookup);
    factors = weighted_rank_one(f, q, light_weights, 1, std::move(factors));
    bound(factors.light, start_light);
    bound(factors.view, start_view);
  }
}

}  // namespace weft::cmf
