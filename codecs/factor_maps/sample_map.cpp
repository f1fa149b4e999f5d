#include "codecs/factor_maps/sample_map.h"

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace weft::factor_maps {

namespace {

// Rows of B B^T are at least 1/4 on the diagonal; eps keeps it invertible where samples are closer
// than texels.
constexpr double ridge = 1e-5;
constexpr int max_corrections = 16;  // one does where no texel falls below zero
constexpr float tolerance = 1e-6F;   // of the largest sample

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

Lanes largest_magnitude(const LaneVector& values) {
  Lanes largest;
  for (const Lanes& value : values) {
    for (int k = 0; k < lane_count; ++k) largest[k] = std::max(largest[k], std::abs(value[k]));
  }
  return largest;
}

}  // namespace

SampleMap::SampleMap(const HemisphereSampling& sampling, const ParabolicMap& map) {
  for (int texel = 0; texel < map.texels(); ++texel) {
    stencils_.push_back(sampling.locate(map.direction(texel)));
  }
  for (const Direction& direction : sampling.directions()) taps_.push_back(map.taps(direction));
  inverse_ = correction_inverse(taps_, map.texels());
}

// p - B m.
LaneVector SampleMap::errors(const LaneVector& samples, const LaneVector& map) const {
  LaneVector error = samples;
  for (std::size_t i = 0; i < error.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      add_scaled(error[i], -taps_[i].weight[k], map[taps_[i].index[k]]);
    }
  }
  return error;
}

// m += B^T (B B^T + eps I)^-1 error, kept >= 0.
void SampleMap::correct(const LaneVector& error, LaneVector& map) const {
  for (std::size_t i = 0; i < error.size(); ++i) {
    const float* row = inverse_.col(static_cast<Eigen::Index>(i)).data();  // symmetric
    Lanes change;
    for (std::size_t j = 0; j < error.size(); ++j) add_scaled(change, row[j], error[j]);
    for (std::size_t k = 0; k < 4; ++k) {
      add_scaled(map[taps_[i].index[k]], taps_[i].weight[k], change);
    }
  }
  for (Lanes& texel : map) {
    for (int k = 0; k < lane_count; ++k) texel[k] = std::max(texel[k], 0.0F);
  }
}

LaneVector SampleMap::map_of(const LaneVector& samples) const {
  LaneVector map(stencils_.size());
  for (std::size_t t = 0; t < map.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      add_scaled(map[t], stencils_[t].weight[k], samples[stencils_[t].index[k]]);
    }
  }
  return corrected(std::move(map), samples);
}

LaneVector SampleMap::corrected(LaneVector map, const LaneVector& samples) const {
  const Lanes largest = largest_magnitude(samples);
  for (int round = 0; round < max_corrections; ++round) {
    const LaneVector error = errors(samples, map);
    const Lanes worst = largest_magnitude(error);
    bool settled = true;
    for (int k = 0; k < lane_count; ++k) settled = settled && worst[k] <= tolerance * largest[k];
    if (settled) break;
    correct(error, map);
  }
  return map;
}

}  // namespace weft::factor_maps
