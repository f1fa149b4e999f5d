// The least squares problem of homomorphic factorisation (paper 004, section 4.3): the logarithms
// of an ABRDF's samples as sums of bilinear lookups in three maps, smoothed by a Laplacian.
//
//   minimise  mean over samples of (M x - log f)^2 + lambda^2 mean over texels of (L x)^2
//
// The matrix is the same for all texels and channels of a BTF: it is factored once, and solved for
// 48 right-hand sides at a time, a lane each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "codecs/factor_maps/lanes.h"
#include "codecs/factor_maps/parabolic_map.h"

namespace weft::hf {

using factor_maps::DoubleLanes;
using factor_maps::LaneVector;
/// A number for each lane and [factor][row][column] or [light][view].
using DoubleVector = std::vector<DoubleLanes>;

/// Factors over light, half-vector and view, in this order.
constexpr int factor_count = 3;

/// M: which texels each [light][view] pair asks for.
class LogLookup {
 public:
  LogLookup(const HemisphereSampling& lights, const HemisphereSampling& views,
            const factor_maps::ParabolicMap& map);

  std::size_t pairs() const { return half_.size(); }
  std::size_t unknowns() const { return factor_count * map_texels_; }
  std::size_t map_texels() const { return map_texels_; }
  const factor_maps::BilinearTaps& taps(std::size_t pair, int factor) const;

  DoubleVector times(const DoubleVector& x) const;             ///< M x
  DoubleVector transposed_times(const DoubleVector& f) const;  ///< M^T f
  /// The texels that each pair's half-vector asks for, within its map.
  const std::vector<factor_maps::BilinearTaps>& half() const { return half_; }

 private:
  std::size_t map_texels_;
  std::vector<factor_maps::BilinearTaps> light_;
  std::vector<factor_maps::BilinearTaps> half_;
  std::vector<factor_maps::BilinearTaps> view_;
};

/// (M^T M / samples + lambda^2 L^T L / texels + a tiny ridge), factored by sparse Cholesky. The
/// ridge settles the constants that the factors could give each other, and nothing else.
class LogSystem {
 public:
  LogSystem(const LogLookup& lookup, int resolution, double lambda);

  /// x for right-hand sides M^T log f / samples. Thread-safe.
  DoubleVector solve(const DoubleVector& right) const;

  /// Entries of the Cholesky factor.
  std::size_t entries() const { return row_.size(); }

 private:
  std::vector<std::uint32_t> place_;  // of an unknown in the factor's order
  std::vector<std::size_t> start_;    // columns of the factor, its diagonal first
  std::vector<std::uint32_t> row_;
  std::vector<double> value_;
};

}  // namespace weft::hf
