#include "codecs/factor_maps/map_equations.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace weft::factor_maps {

namespace {

using Eigen::Index;

constexpr int max_iterations = 40;
constexpr int max_rounds = 4;
constexpr double tolerance = 1e-4;  // of the residual's length

}  // namespace

MapEquations::MapEquations(int resolution, double smoothness)
    : resolution_(resolution), stride_(resolution + 1), smoothness_(smoothness) {
  const Values zeros = Values::Zero((resolution_ + 2) * stride_ + 1);
  matrix_ = {zeros, zeros, zeros, zeros, zeros};
  residual_ = zeros;
}

// One column of zeros between rows, a row of them above and below.
Index MapEquations::place(Index texel) const {
  return (texel / resolution_ + 1) * stride_ + texel % resolution_ + 1;
}

void MapEquations::add(const BilinearTaps& taps, double weight, double residual) {
  const Index a = place(taps.index[0]);
  const std::array<Index, 4> places{a, a + 1, a + stride_, a + stride_ + 1};
  const std::array<double, 4> w{taps.weight[0], taps.weight[1], taps.weight[2], taps.weight[3]};
  for (std::size_t k = 0; k < 4; ++k) {
    matrix_.own[places[k]] += weight * w[k] * w[k];
    residual_[places[k]] += w[k] * residual;
  }
  matrix_.right[places[0]] += weight * w[0] * w[1];
  matrix_.right[places[2]] += weight * w[2] * w[3];
  matrix_.below[places[0]] += weight * w[0] * w[2];
  matrix_.below[places[1]] += weight * w[1] * w[3];
  matrix_.below_right[places[0]] += weight * w[0] * w[3];
  matrix_.below_left[places[1]] += weight * w[1] * w[2];
}

MapEquations::Values MapEquations::times(const Matrix& matrix, const Values& x) const {
  Values y = Values::Zero(x.size());
  const Index first = stride_ + 1;
  const Index count = x.size() - 2 * first;
  const auto there = [&](const Values& v, Index offset) {
    return v.segment(first + offset, count);
  };
  const auto both = [&](const Values& entries, Index offset) {
    return there(entries, 0) * there(x, offset) + there(entries, -offset) * there(x, -offset);
  };
  y.segment(first, count) = there(matrix.own, 0) * there(x, 0) + both(matrix.right, 1) +
                            both(matrix.below_left, stride_ - 1) + both(matrix.below, stride_) +
                            both(matrix.below_right, stride_ + 1);
  return y;
}

// With mu times the squared differences between neighbours.
MapEquations::Matrix MapEquations::smoothed(double mu) const {
  Matrix matrix = matrix_;
  const auto join = [&](Values& entries, Index texel, Index other) {
    matrix.own[place(texel)] += mu;
    matrix.own[place(other)] += mu;
    entries[place(texel)] -= mu;
  };
  for (Index texel = 0; texel < resolution_ * resolution_; ++texel) {
    if (texel % resolution_ + 1 < resolution_) join(matrix.right, texel, texel + 1);
    if (texel / resolution_ + 1 < resolution_) join(matrix.below, texel, texel + resolution_);
  }
  return matrix;
}

// From `start` on, where `free` is 1; what is held, where it is 0, stays as it is there.
MapEquations::Values MapEquations::change(const Matrix& matrix, const Values& start,
                                          const Values& free) const {
  const Values inverse = free * (matrix.own > 0).select(1 / matrix.own, 0.0);
  Values x = start;
  Values r = residual_ - times(matrix, x);
  Values z = inverse * r;
  Values p = z;
  double rz = (r * z).sum();
  const double enough = tolerance * tolerance * rz;
  for (int iteration = 0; iteration < max_iterations && rz > enough; ++iteration) {
    const Values ap = times(matrix, p);
    const double step = rz / (p * ap).sum();
    x += step * p;
    r -= step * ap;
    z = inverse * r;
    const double next = (r * z).sum();
    p = z + next / rz * p;
    rz = next;
  }
  return x;
}

std::vector<double> MapEquations::solved(const std::vector<double>& map) const {
  const double mu = smoothness_ * matrix_.own.sum() / static_cast<double>(map.size());
  if (!(mu > 0)) return map;
  const Matrix matrix = smoothed(mu);
  Values now = Values::Zero(residual_.size());
  for (std::size_t t = 0; t < map.size(); ++t) now[place(static_cast<Index>(t))] = map[t];
  Values x = Values::Zero(residual_.size());
  Values free = Values::Ones(residual_.size());
  for (int round = 0; round < max_rounds; ++round) {
    x = change(matrix, x, free);
    const auto below = now + x < 0;
    if (!below.any()) break;
    free = below.select(0.0, free);
    x = x.max(-now);
  }
  const double gain = (x * (2 * residual_ - times(matrix_, x))).sum();
  if (!(gain > 0)) return map;
  now = (now + x).max(0.0);
  std::vector<double> result(map.size());
  for (std::size_t t = 0; t < map.size(); ++t) result[t] = now[place(static_cast<Index>(t))];
  return result;
}

}  // namespace weft::factor_maps
