// The chain of matrix decompositions of one block of ABRDFs (paper 004, section 4.2.3): one link
// over half-vector and difference, one over light and view, each fitted to what the other leaves.
#pragma once

#include <optional>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "codecs/cmf/half_link.h"
#include "codecs/cmf/low_rank.h"
#include "codecs/factor_maps/model.h"
#include "codecs/factor_maps/sample_map.h"

namespace weft::cmf {

/// Which error the step over light and view makes least: of the residual f / Q, each pair alike
/// (the paper's SVD), or of B, as it is seen.
enum class RankOne { weighted, plain };

/// Which link is fitted first. The paper ends with light and view, where no resampling is.
enum class Order { half_first, half_last };

struct ChainOptions {
  int resolution = 32;             ///< texels a side of each factor's map
  bool half = true;                ///< with the factor over the half-vector, Q
  bool difference = false;         ///< with the factor over the difference, D; needs `half`
  int terms = 1;                   ///< of the links of two factors
  Sign sign = Sign::non_negative;  ///< of several terms
  Order order = Order::half_first;
  int difference_rings = 8;  ///< of the grid that Q averages over: rings x 2 rings
  RankOne rank_one = RankOne::weighted;
  int refine = 2;  ///< rounds that alternate over all factors
};

/// One factor's maps, [term][row][column].
struct FactorMaps {
  factor_maps::Projection projection;
  LaneVector maps;
};

class Chain {
 public:
  Chain(const HemisphereSampling& lights, const HemisphereSampling& views,
        const ChainOptions& options);

  /// @param f  B / cos(theta_light) of the block, [light][view], finite and >= 0.
  /// Factors in the order of `Projection`. A lane of zeros gives maps of zeros over light and view.
  std::vector<FactorMaps> factorise(const LaneVector& f) const;

 private:
  LightView light_and_view(const LaneVector& f, const LaneVector& q) const;
  void refine(const LaneVector& f, LightView& factors, HalfMaps& half) const;
  LaneVector maps_of(const factor_maps::SampleMap& maker, const LaneVector& samples) const;

  std::size_t n_lights_;
  std::size_t n_views_;
  ChainOptions options_;
  factor_maps::SampleMap light_map_;
  factor_maps::SampleMap view_map_;
  std::optional<HalfLink> half_link_;
  std::vector<double> light_weights_;  // cos^2: squares of B's errors, not of f's
};

}  // namespace weft::cmf
