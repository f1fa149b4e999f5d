// A few ABRDFs side by side: the chain runs on 16 texels of 3 channels at once, a lane each.
//
// All operators of the chain but the rank-1 step are linear and the same for every texel and
// channel. Side by side, each of their coefficients is loaded once for 48 lanes, and one ABRDF
// block (6,561 pairs) stays in L2.
#pragma once

#include <cstddef>
#include <vector>

namespace weft::factor_maps {

constexpr int texels_a_block = 16;
constexpr int lane_count = 3 * texels_a_block;

/// One number for each lane; lane 3 t + c is channel c of the block's texel t.
template <typename Value>
struct alignas(64) LanesOf {
  Value lane[lane_count] = {};
  Value& operator[](int k) { return lane[k]; }
  const Value& operator[](int k) const { return lane[k]; }
};
using Lanes = LanesOf<float>;
using DoubleLanes = LanesOf<double>;

/// A vector (a map's texels, the samples of a factor, or all [light][view] pairs) for each lane.
using LaneVector = std::vector<Lanes>;

template <typename Sum>
inline void add_scaled(Sum& sum, float weight, const Lanes& values) {
  for (int k = 0; k < lane_count; ++k) sum[k] += weight * values[k];
}

}  // namespace weft::factor_maps
