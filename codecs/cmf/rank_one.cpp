#include "codecs/cmf/rank_one.h"

#include <algorithm>
#include <cmath>

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

}  // namespace weft::cmf
