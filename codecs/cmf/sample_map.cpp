#include "codecs/cmf/sample_map.h"

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>

namespace weft::cmf {

namespace {

// Rows of B B^T are at least 1/4 on the diagonal; eps keeps it invertible where samples are closer
// than texels.
constexpr double ridge = 1e-5;
constexpr int corrections = 4;

Eigen::MatrixXf correction_inverse(const std::vector<BilinearTaps>& taps, int texels) {
  const auto n = static_cast<Eigen::Index>(taps.size());
  std::vector<std::vector<std::pair<Eigen::Index, double>>> users(static_cast<std::size_t>(texels));
  for (Eigen::Index i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < 4; ++k) users[taps[i].index[k]].emplace_back(i, taps[i].weight[k]);
  }
  Eigen::MatrixXd gram = ridge * Eigen::MatrixXd::Identity(n, n);
  for (const auto& texel : users) {
    for (const auto& [i, a] : texel) {
      for (const auto& [j, b] : texel) gram(i, j) += a * b;
    }
  }
  return gram.llt().solve(Eigen::MatrixXd::Identity(n, n)).cast<float>();
}

}  // namespace

SampleMap::SampleMap(const HemisphereSampling& sampling, const ParabolicMap& map) {
  for (int texel = 0; texel < map.texels(); ++texel) {
    stencils_.push_back(sampling.locate(map.direction(texel)));
  }
  for (const Direction& direction : sampling.directions()) taps_.push_back(map.taps(direction));
  inverse_ = correction_inverse(taps_, map.texels());
}

LaneVector SampleMap::map_of(const LaneVector& samples) const {
  LaneVector map(stencils_.size());
  for (std::size_t t = 0; t < map.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      add_scaled(map[t], stencils_[t].weight[k], samples[stencils_[t].index[k]]);
    }
  }
  LaneVector error(samples.size());
  for (int round = 0; round < corrections; ++round) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      error[i] = samples[i];
      for (std::size_t k = 0; k < 4; ++k) {
        add_scaled(error[i], -taps_[i].weight[k], map[taps_[i].index[k]]);
      }
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
      Lanes change;
      for (std::size_t j = 0; j < samples.size(); ++j) {
        add_scaled(change, inverse_(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)),
                   error[j]);
      }
      for (std::size_t k = 0; k < 4; ++k)
        add_scaled(map[taps_[i].index[k]], taps_[i].weight[k], change);
    }
    for (Lanes& texel : map) {
      for (int k = 0; k < lane_count; ++k) texel[k] = std::max(texel[k], 0.0F);
    }
  }
  return map;
}

}  // namespace weft::cmf
