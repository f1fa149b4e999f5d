#include "codecs/cmf/refinement.h"

namespace weft::cmf {

namespace {

Lanes looked_up(const LaneVector& map, const BilinearTaps& taps) {
  Lanes value;
  for (std::size_t k = 0; k < 4; ++k) add_scaled(value, taps.weight[k], map[taps.index[k]]);
  return value;
}

float ratio_or(double numerator, double denominator, float otherwise) {
  return denominator > 0 ? static_cast<float>(numerator / denominator) : otherwise;
}

// P_i = sum_j f Q R / sum_j (Q R)^2, then R_j likewise with the new P, in one pass over the pairs.
void solve_light_and_view(const LaneVector& f, std::span<const BilinearTaps> lookup,
                          std::span<const double> light_weights, const LaneVector& half,
                          LightView& factors) {
  const std::size_t n_views = factors.view.size();
  std::vector<DoubleLanes> numerator(n_views);
  std::vector<DoubleLanes> denominator(n_views);
  LaneVector q(n_views);
  for (std::size_t i = 0; i < factors.light.size(); ++i) {
    const Lanes* row = &f[i * n_views];
    DoubleLanes top;
    DoubleLanes bottom;
    for (std::size_t j = 0; j < n_views; ++j) {
      q[j] = looked_up(half, lookup[i * n_views + j]);
      for (int k = 0; k < lane_count; ++k) {
        const double qr = q[j][k] * factors.view[j][k];
        top[k] += row[j][k] * qr;
        bottom[k] += qr * qr;
      }
    }
    Lanes& p = factors.light[i];
    for (int k = 0; k < lane_count; ++k) p[k] = ratio_or(top[k], bottom[k], p[k]);
    for (std::size_t j = 0; j < n_views; ++j) {
      for (int k = 0; k < lane_count; ++k) {
        const double pq = p[k] * q[j][k];
        numerator[j][k] += light_weights[i] * row[j][k] * pq;
        denominator[j][k] += light_weights[i] * pq * pq;
      }
    }
  }
  for (std::size_t j = 0; j < n_views; ++j) {
    Lanes& r = factors.view[j];
    for (int k = 0; k < lane_count; ++k) r[k] = ratio_or(numerator[j][k], denominator[j][k], r[k]);
  }
}

// Q_t *= (L^T w P R f)_t / (L^T w (P R)^2 L Q)_t, L the lookup.
void scale_half(const LaneVector& f, std::span<const BilinearTaps> lookup,
                std::span<const double> light_weights, const LightView& factors, LaneVector& half) {
  const std::size_t n_views = factors.view.size();
  LaneVector wanted(half.size());
  LaneVector present(half.size());
  for (std::size_t i = 0; i < factors.light.size(); ++i) {
    const auto w = static_cast<float>(light_weights[i]);
    for (std::size_t j = 0; j < n_views; ++j) {
      const std::size_t pair = i * n_views + j;
      const BilinearTaps& taps = lookup[pair];
      const Lanes q = looked_up(half, taps);
      Lanes top;
      Lanes bottom;
      for (int k = 0; k < lane_count; ++k) {
        const float pr = factors.light[i][k] * factors.view[j][k];
        top[k] = w * pr * f[pair][k];
        bottom[k] = w * pr * pr * q[k];
      }
      for (std::size_t t = 0; t < 4; ++t) {
        add_scaled(wanted[taps.index[t]], taps.weight[t], top);
        add_scaled(present[taps.index[t]], taps.weight[t], bottom);
      }
    }
  }
  for (std::size_t t = 0; t < half.size(); ++t) {
    for (int k = 0; k < lane_count; ++k) half[t][k] *= ratio_or(wanted[t][k], present[t][k], 1.0F);
  }
}

}  // namespace

void refine(const LaneVector& f, std::span<const BilinearTaps> lookup,
            std::span<const double> light_weights, int rounds, LightView& factors,
            LaneVector& half) {
  for (int round = 0; round < rounds; ++round) {
    scale_half(f, lookup, light_weights, factors, half);
    solve_light_and_view(f, lookup, light_weights, half, factors);
  }
}

}  // namespace weft::cmf
