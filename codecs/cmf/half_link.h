// The link of the chain over half-vector and difference: sum over terms of Q_k(half) D_k(diff), D
// being 1 where there is no factor over the difference.
#pragma once

#include <span>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "codecs/cmf/low_rank.h"
#include "codecs/factor_maps/half_difference.h"
#include "codecs/factor_maps/parabolic_map.h"

namespace weft::cmf {

/// Maps [term][texel], all >= 0 but for signed ones; `difference` is empty where there is none.
struct HalfMaps {
  LaneVector half;
  LaneVector difference;
};

class HalfLink {
 public:
  /// @param rings  of the grid of differences that a half map averages over: rings x 2 rings.
  HalfLink(const HemisphereSampling& lights, const HemisphereSampling& views,
           const factor_maps::ParabolicMap& map, int rings, bool with_difference, int terms);

  /// The paper's start (section 4.2.3): Q is f averaged over the differences, raised to 1e-4 of its
  /// largest value, which keeps the residual (equation 7) finite; D_1 is 1. Further terms begin as
  /// powers of the difference's cosine. A lane of zeros gives maps of ones.
  /// @param f  [light][view], finite and >= 0.
  HalfMaps start(const LaneVector& f) const;

  /// The link's value at each [light][view] pair, raised to 0 where it is less.
  LaneVector values(const HalfMaps& maps) const;

  /// One round that lowers sum over pairs of w_light (f - others * link)^2, the link as it is
  /// before what is less is raised to 0, Q's texels and then D's: by the multiplicative updates of
  /// Lee and Seung, which keep them >= 0; or, signed, along the gradient that each texel's
  /// curvature scales, to the least of the sum. Where there are fewer pairs than the map has texels
  /// for, updates are spread over neighbours, and of the first kind may raise the sum.
  /// @param others         the product of the other links at each pair, >= 0.
  /// @param light_weights  w_light, > 0, one a light.
  /// @param sign           non-negative of maps that are.
  void update(const LaneVector& f, const LaneVector& others, std::span<const double> light_weights,
              Sign sign, HalfMaps& maps) const;

 private:
  LaneVector signed_sum(const HalfMaps& maps) const;
  void update_map(const LaneVector& f, const LaneVector& others,
                  std::span<const double> light_weights, Sign sign, bool of_half, int term,
                  HalfMaps& maps) const;

  int terms_;
  bool with_difference_;
  factor_maps::ParabolicMap map_;
  int spread_;  // passes of a blur of the updates
  factor_maps::SparseRows average_;
  std::vector<factor_maps::BilinearTaps> half_lookup_;
  std::vector<factor_maps::BilinearTaps> difference_lookup_;
};

}  // namespace weft::cmf
