// The chain of matrix decompositions of one block of ABRDFs (paper 004, section 4.2.3): Q over the
// half-vector from the resampled data, then P over the light and R over the view from what Q
// leaves.
#pragma once

#include <vector>

#include "btf/hemisphere_sampling.h"
#include "codecs/cmf/half_difference.h"
#include "codecs/cmf/lanes.h"
#include "codecs/cmf/parabolic_map.h"
#include "codecs/cmf/rank_one.h"
#include "codecs/cmf/sample_map.h"

namespace weft::cmf {

/// Which error the rank-1 step over light and view makes least: of the residual f / Q, each pair
/// alike (the paper's SVD), or of B, as it is seen.
enum class RankOne { weighted, plain };

struct ChainOptions {
  int resolution = 32;       ///< texels a side of each factor's map
  bool half = true;          ///< with the factor over the half-vector, Q
  int difference_rings = 8;  ///< of the grid that Q averages over: rings x 2 rings
  RankOne rank_one = RankOne::weighted;
  int refine = 0;  ///< rounds that alternate over all factors
};

/// Maps over the light, the half-vector and the view; `half` is empty without Q.
struct FactorMaps {
  LaneVector light;
  LaneVector half;
  LaneVector view;
};

class Chain {
 public:
  Chain(const HemisphereSampling& lights, const HemisphereSampling& views,
        const ChainOptions& options);

  /// @param f  B / cos(theta_light) of the block, [light][view], finite and >= 0.
  /// A lane of zeros gives maps of zeros over light and view.
  FactorMaps factorise(const LaneVector& f) const;

 private:
  LaneVector half_map(const LaneVector& f) const;
  LightView light_and_view(const LaneVector& f, const LaneVector& q) const;

  std::size_t n_lights_;
  std::size_t n_views_;
  ChainOptions options_;
  SampleMap light_map_;
  SampleMap view_map_;
  SparseRows average_;
  std::vector<BilinearTaps> lookup_;
  std::vector<double> light_weights_;  // cos^2: squares of B's errors, not of f's
};

}  // namespace weft::cmf
