#include "codecs/cmf/rank_one.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace weft::cmf {

namespace {

constexpr int max_iterations = 60;
constexpr double tolerance = 1e-7;

using Vector = std::vector<DoubleLanes>;

// One power step on F^T F: u = F v and F^T u, in one pass over F.
struct Step {
  Vector u;
  Vector v;
};

Step power_step(const LaneVector& f, const Vector& v, std::size_t n_lights) {
  const std::size_t n_views = v.size();
  Step step{Vector(n_lights), Vector(n_views)};
  for (std::size_t i = 0; i < n_lights; ++i) {
    const Lanes* row = &f[i * n_views];
    DoubleLanes u;
    for (std::size_t j = 0; j < n_views; ++j) {
      for (int k = 0; k < lane_count; ++k) u[k] += row[j][k] * v[j][k];
    }
    for (std::size_t j = 0; j < n_views; ++j) {
      for (int k = 0; k < lane_count; ++k) step.v[j][k] += row[j][k] * u[k];
    }
    step.u[i] = u;
  }
  return step;
}

// To a largest value of 1 in each lane; answers the largest change against `before`.
double normalise(Vector& v, const Vector& before) {
  DoubleLanes largest;
  for (const DoubleLanes& value : v) {
    for (int k = 0; k < lane_count; ++k) largest[k] = std::max(largest[k], value[k]);
  }
  double change = 0;
  for (std::size_t j = 0; j < v.size(); ++j) {
    for (int k = 0; k < lane_count; ++k) {
      v[j][k] = largest[k] > 0 ? v[j][k] / largest[k] : 0;
      change = std::max(change, std::abs(v[j][k] - before[j][k]));
    }
  }
  return change;
}

float ratio_or(double numerator, double denominator, float otherwise) {
  return denominator > 0 ? static_cast<float>(numerator / denominator) : otherwise;
}

// P_i = sum_j f Q R / sum_j (Q R)^2.
Lanes solved_light(const Lanes* f, const Lanes* q, const LaneVector& view, const Lanes& before) {
  DoubleLanes top;
  DoubleLanes bottom;
  for (std::size_t j = 0; j < view.size(); ++j) {
    for (int k = 0; k < lane_count; ++k) {
      const double qr = q[j][k] * view[j][k];
      top[k] += f[j][k] * qr;
      bottom[k] += qr * qr;
    }
  }
  Lanes light;
  for (int k = 0; k < lane_count; ++k) light[k] = ratio_or(top[k], bottom[k], before[k]);
  return light;
}

// P, then R_j = sum_i w f P Q / sum_i w (P Q)^2 with the new P, in one pass over the pairs.
void solve_light_and_view(const LaneVector& f, const LaneVector& q,
                          std::span<const double> light_weights, LightView& factors) {
  const std::size_t n_views = factors.view.size();
  Vector top(n_views);
  Vector bottom(n_views);
  for (std::size_t i = 0; i < factors.light.size(); ++i) {
    const Lanes* f_row = &f[i * n_views];
    const Lanes* q_row = &q[i * n_views];
    const Lanes p = solved_light(f_row, q_row, factors.view, factors.light[i]);
    for (std::size_t j = 0; j < n_views; ++j) {
      for (int k = 0; k < lane_count; ++k) {
        const double pq = p[k] * q_row[j][k];
        top[j][k] += light_weights[i] * f_row[j][k] * pq;
        bottom[j][k] += light_weights[i] * pq * pq;
      }
    }
    factors.light[i] = p;
  }
  for (std::size_t j = 0; j < n_views; ++j) {
    Lanes& r = factors.view[j];
    for (int k = 0; k < lane_count; ++k) r[k] = ratio_or(top[j][k], bottom[j][k], r[k]);
  }
}

}  // namespace

LightView rank_one(const LaneVector& f, std::size_t n_lights, std::size_t n_views) {
  DoubleLanes ones;
  std::fill_n(ones.lane, lane_count, 1.0);
  Vector v(n_views, ones);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    Vector next = power_step(f, v, n_lights).v;
    const double change = normalise(next, v);
    v = std::move(next);
    if (change < tolerance) break;
  }
  const Vector u = power_step(f, v, n_lights).u;
  DoubleLanes square;
  for (const DoubleLanes& value : v) {
    for (int k = 0; k < lane_count; ++k) square[k] += value[k] * value[k];
  }
  LightView result{LaneVector(n_lights), LaneVector(n_views)};
  for (std::size_t i = 0; i < n_lights; ++i) {
    for (int k = 0; k < lane_count; ++k) {
      result.light[i][k] = square[k] > 0 ? static_cast<float>(u[i][k] / square[k]) : 0.0F;
    }
  }
  for (std::size_t j = 0; j < n_views; ++j) {
    for (int k = 0; k < lane_count; ++k) result.view[j][k] = static_cast<float>(v[j][k]);
  }
  return result;
}

LightView weighted_rank_one(const LaneVector& f, const LaneVector& q,
                            std::span<const double> light_weights, int rounds, LightView start) {
  for (int round = 0; round < rounds; ++round) solve_light_and_view(f, q, light_weights, start);
  return start;
}

}  // namespace weft::cmf
