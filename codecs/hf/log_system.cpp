#include "codecs/hf/log_system.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "btf/error.h"
#include "codecs/factor_maps/half_difference.h"

namespace weft::hf {

using factor_maps::BilinearTaps;
using factor_maps::lane_count;

namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

// Of the mean diagonal. A shift from one factor to another is then worth 1e-8 of an error of that
// size, far above what double rounds.
constexpr double ridge = 1e-8;

template <typename Sum, typename Values>
void add_scaled_lanes(Sum& sum, double weight, const Values& values) {
  for (int k = 0; k < lane_count; ++k) sum[k] += weight * values[k];
}

std::vector<BilinearTaps> taps_of(const HemisphereSampling& sampling,
                                  const factor_maps::ParabolicMap& map) {
  std::vector<BilinearTaps> taps;
  for (const Direction& direction : sampling.directions()) taps.push_back(map.taps(direction));
  return taps;
}

// M^T M / samples, from the pairs' twelve texels.
Matrix normal_matrix(const LogLookup& lookup) {
  const auto n = static_cast<Eigen::Index>(lookup.unknowns());
  Matrix sum(n, n);
  Triplets entries;
  const double weight = 1.0 / static_cast<double>(lookup.pairs());
  const auto flush = [&] {
    Matrix part(n, n);
    part.setFromTriplets(entries.begin(), entries.end());
    sum += part;
    entries.clear();
  };
  for (std::size_t pair = 0; pair < lookup.pairs(); ++pair) {
    std::array<std::pair<int, double>, 4 * factor_count> row;
    for (int f = 0; f < factor_count; ++f) {
      const BilinearTaps& taps = lookup.taps(pair, f);
      for (std::size_t t = 0; t < 4; ++t) {
        row[4 * f + t] = {static_cast<int>(f * lookup.map_texels() + taps.index[t]),
                          taps.weight[t]};
      }
    }
    for (const auto& [i, a] : row) {
      for (const auto& [j, b] : row) {
        if (j <= i) entries.emplace_back(i, j, weight * a * b);
      }
    }
    if (entries.size() > 4'000'000) flush();
  }
  flush();
  return sum;
}

// L: each texel's difference to the mean of its neighbours within the map.
Matrix laplacian(int resolution, std::size_t unknowns) {
  Triplets entries;
  const int texels = resolution * resolution;
  for (int i = 0; i < static_cast<int>(unknowns); ++i) {
    const int x = i % texels % resolution;
    const int y = i % texels / resolution;
    std::vector<int> neighbours;
    if (x > 0) neighbours.push_back(i - 1);
    if (x + 1 < resolution) neighbours.push_back(i + 1);
    if (y > 0) neighbours.push_back(i - resolution);
    if (y + 1 < resolution) neighbours.push_back(i + resolution);
    entries.emplace_back(i, i, 1.0);
    for (const int j : neighbours)
      entries.emplace_back(i, j, -1.0 / static_cast<double>(neighbours.size()));
  }
  Matrix matrix(static_cast<Eigen::Index>(unknowns), static_cast<Eigen::Index>(unknowns));
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

LogLookup::LogLookup(const HemisphereSampling& lights, const HemisphereSampling& views,
                     const factor_maps::ParabolicMap& map)
    : map_texels_(static_cast<std::size_t>(map.texels())),
      light_(taps_of(lights, map)),
      half_(factor_maps::half_lookup(lights, views, map)),
      view_(taps_of(views, map)) {}

const BilinearTaps& LogLookup::taps(std::size_t pair, int factor) const {
  return factor == 0   ? light_[pair / view_.size()]
         : factor == 1 ? half_[pair]
                       : view_[pair % view_.size()];
}

DoubleVector LogLookup::times(const DoubleVector& x) const {
  DoubleVector result(pairs());
  for (int f = 0; f < factor_count; ++f) {
    const DoubleLanes* map = &x[f * map_texels_];
    for (std::size_t pair = 0; pair < result.size(); ++pair) {
      const BilinearTaps& own = taps(pair, f);
      for (std::size_t t = 0; t < 4; ++t)
        add_scaled_lanes(result[pair], own.weight[t], map[own.index[t]]);
    }
  }
  return result;
}

// The sums over all views of a light, and over all lights of a view, are made first: twelve
// texels a pair become six.
DoubleVector LogLookup::transposed_times(const DoubleVector& f) const {
  DoubleVector result(unknowns());
  DoubleVector of_light(light_.size());
  DoubleVector of_view(view_.size());
  const auto spread = [&](int factor, const BilinearTaps& own, const DoubleLanes& value) {
    for (std::size_t t = 0; t < 4; ++t) {
      add_scaled_lanes(result[factor * map_texels_ + own.index[t]], own.weight[t], value);
    }
  };
  for (std::size_t pair = 0; pair < f.size(); ++pair) {
    add_scaled_lanes(of_light[pair / view_.size()], 1.0, f[pair]);
    add_scaled_lanes(of_view[pair % view_.size()], 1.0, f[pair]);
    spread(1, half_[pair], f[pair]);
  }
  for (std::size_t i = 0; i < light_.size(); ++i) spread(0, light_[i], of_light[i]);
  for (std::size_t j = 0; j < view_.size(); ++j) spread(2, view_[j], of_view[j]);
  return result;
}

LogSystem::LogSystem(const LogLookup& lookup, int resolution, double lambda) {
  const Matrix smooth = laplacian(resolution, lookup.unknowns());
  const auto n = static_cast<Eigen::Index>(lookup.unknowns());
  Matrix a = normal_matrix(lookup);
  const Matrix penalty = smooth.transpose() * smooth;
  a += Matrix(penalty.triangularView<Eigen::Lower>()) * (lambda * lambda / static_cast<double>(n));
  const double scale = a.diagonal().mean();
  for (Eigen::Index i = 0; i < n; ++i) a.coeffRef(i, i) += ridge * scale;
  const Eigen::SimplicialLLT<Matrix, Eigen::Lower> cholesky(a);
  if (cholesky.info() != Eigen::Success) {
    throw bad_input("lambda", "is too small: the system has no unique solution");
  }
  place_.resize(lookup.unknowns());
  for (Eigen::Index i = 0; i < n; ++i)
    place_[i] = static_cast<std::uint32_t>(cholesky.permutationP().indices()[i]);
  const Matrix factor = cholesky.matrixL();
  start_.push_back(0);
  for (Eigen::Index column = 0; column < n; ++column) {
    for (Matrix::InnerIterator entry(factor, column); entry; ++entry) {
      row_.push_back(static_cast<std::uint32_t>(entry.row()));
      value_.push_back(entry.value());
    }
    start_.push_back(row_.size());
  }
}

// L y = b, then L^T x = y. Each entry of the factor is loaded once for 48 lanes.
DoubleVector LogSystem::solve(const DoubleVector& right) const {
  const std::size_t n = place_.size();
  DoubleVector x(n);
  for (std::size_t i = 0; i < n; ++i) x[place_[i]] = right[i];
  for (std::size_t column = 0; column < n; ++column) {
    const std::size_t diagonal = start_[column];
    DoubleLanes& own = x[column];
    const double inverse = 1 / value_[diagonal];
    for (int k = 0; k < lane_count; ++k) own[k] *= inverse;
    for (std::size_t e = diagonal + 1; e < start_[column + 1]; ++e)
      add_scaled_lanes(x[row_[e]], -value_[e], own);
  }
  for (std::size_t column = n; column-- > 0;) {
    const std::size_t diagonal = start_[column];
    DoubleLanes sum = x[column];
    for (std::size_t e = diagonal + 1; e < start_[column + 1]; ++e)
      add_scaled_lanes(sum, -value_[e], x[row_[e]]);
    const double inverse = 1 / value_[diagonal];
    for (int k = 0; k < lane_count; ++k) x[column][k] = sum[k] * inverse;
  }
  DoubleVector result(n);
  for (std::size_t i = 0; i < n; ++i) result[i] = x[place_[i]];
  return result;
}

}  // namespace weft::hf
