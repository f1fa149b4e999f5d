#include "codecs/factor_maps/map_equations.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace weft::factor_maps {

namespace {

constexpr int max_iterations = 40;
constexpr int max_rounds = 4;
constexpr double tolerance = 1e-4;  // of the residual's length

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

}  // namespace

MapEquations::MapEquations(int resolution, double smoothness)
    : resolution_(resolution),
      smoothness_(smoothness),
      own_(static_cast<std::size_t>(resolution) * resolution),
      right_(own_.size()),
      below_left_(own_.size()),
      below_(own_.size()),
      below_right_(own_.size()),
      residual_(own_.size()) {}

void MapEquations::add(const BilinearTaps& taps, double weight, double residual) {
  const auto& [a, b, c, d] = taps.index;  // upper left, upper right, lower left, lower right
  const std::array<double, 4> w{taps.weight[0], taps.weight[1], taps.weight[2], taps.weight[3]};
  for (std::size_t k = 0; k < 4; ++k) {
    own_[taps.index[k]] += weight * w[k] * w[k];
    residual_[taps.index[k]] += w[k] * residual;
  }
  right_[a] += weight * w[0] * w[1];
  right_[c] += weight * w[2] * w[3];
  below_[a] += weight * w[0] * w[2];
  below_[b] += weight * w[1] * w[3];
  below_right_[a] += weight * w[0] * w[3];
  below_left_[b] += weight * w[1] * w[2];
}

std::vector<double> MapEquations::times(const std::vector<double>& x, double mu) const {
  std::vector<double> y(x.size());
  const auto n = static_cast<std::size_t>(resolution_);
  const auto join = [&](std::size_t i, std::size_t j, double entry) {
    y[i] += entry * x[j] + mu * (x[i] - x[j]);
    y[j] += entry * x[i] + mu * (x[j] - x[i]);
  };
  for (std::size_t row = 0; row < n; ++row) {
    for (std::size_t i = row * n; i < (row + 1) * n; ++i) {
      y[i] += own_[i] * x[i];
      const bool last_column = i + 1 == (row + 1) * n;
      if (!last_column) join(i, i + 1, right_[i]);
      if (row + 1 == n) continue;
      join(i, i + n, below_[i]);
      if (!last_column) {
        y[i] += below_right_[i] * x[i + n + 1];
        y[i + n + 1] += below_right_[i] * x[i];
      }
      if (i > row * n) {
        y[i] += below_left_[i] * x[i + n - 1];
        y[i + n - 1] += below_left_[i] * x[i];
      }
    }
  }
  return y;
}

// From `start` on; what is held stays as it is there.
std::vector<double> MapEquations::change(const std::vector<double>& start,
                                         const std::vector<bool>& held, double mu) const {
  const auto preconditioned = [&](const std::vector<double>& r) {
    std::vector<double> z(r.size());
    for (std::size_t i = 0; i < r.size(); ++i) z[i] = held[i] ? 0 : r[i] / (own_[i] + 4 * mu);
    return z;
  };
  std::vector<double> x = start;
  std::vector<double> r = times(x, mu);
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = residual_[i] - r[i];
  std::vector<double> z = preconditioned(r);
  std::vector<double> p = z;
  double rz = dot(r, z);
  const double enough = tolerance * tolerance * rz;
  for (int iteration = 0; iteration < max_iterations && rz > enough; ++iteration) {
    const std::vector<double> ap = times(p, mu);
    const double step = rz / dot(p, ap);
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += step * p[i];
      r[i] -= step * ap[i];
    }
    z = preconditioned(r);
    const double next = dot(r, z);
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = z[i] + next / rz * p[i];
    rz = next;
  }
  return x;
}

std::vector<double> MapEquations::solved(const std::vector<double>& map) const {
  const double trace = std::accumulate(own_.begin(), own_.end(), 0.0);
  const double mu = smoothness_ * trace / static_cast<double>(own_.size());
  if (!(mu > 0)) return map;
  std::vector<double> x(map.size());
  std::vector<bool> held(map.size());
  for (int round = 0; round < max_rounds; ++round) {
    x = change(x, held, mu);
    bool below = false;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (held[i] || map[i] + x[i] >= 0) continue;
      x[i] = -map[i];
      held[i] = true;
      below = true;
    }
    if (!below) break;
  }
  const std::vector<double> ax = times(x, 0);
  double gain = 0;
  for (std::size_t i = 0; i < x.size(); ++i) gain += x[i] * (2 * residual_[i] - ax[i]);
  if (!(gain > 0)) return map;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::max(x[i] + map[i], 0.0);
  return x;
}

}  // namespace weft::factor_maps
