// From a factor's values at the sampled directions to its parabolic map.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "codecs/factor_maps/lanes.h"
#include "codecs/factor_maps/parabolic_map.h"

namespace weft::factor_maps {

/// Starts from barycentric interpolation at each texel, then adds the least change (in the 2-norm)
/// that makes the map's own bilinear lookup return the samples: m += B^T (B B^T + eps I)^-1 (p - B
/// m), B the lookup matrix. Texels are kept >= 0, and the step is repeated so that what that took
/// away is made good by the neighbours.
class SampleMap {
 public:
  SampleMap(const HemisphereSampling& sampling, const ParabolicMap& map);

  /// @param samples  one entry a sampled direction, >= 0. @return one entry a texel, >= 0.
  LaneVector map_of(const LaneVector& samples) const;

  /// `map` changed so that its lookup returns the samples; both >= 0.
  LaneVector corrected(LaneVector map, const LaneVector& samples) const;

  /// The map's texels that each sampled direction asks for.
  const std::vector<BilinearTaps>& taps() const { return taps_; }

 private:
  LaneVector errors(const LaneVector& samples, const LaneVector& map) const;
  void correct(const LaneVector& error, LaneVector& map) const;

  std::vector<Stencil> stencils_;   // per texel
  std::vector<BilinearTaps> taps_;  // per sample
  Eigen::MatrixXf inverse_;         // (B B^T + eps I)^-1
};

}  // namespace weft::factor_maps
