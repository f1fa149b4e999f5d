// The pairs that a fit sees, as its loops want them: arrays side by side, whole blocks.
#pragma once

#include <span>
#include <vector>

#include "btf/hemisphere_sampling.h"

namespace weft::srbf {

/// What the kernels' sum stands for: B itself, or f = B / cos(theta_light).
enum class Quantity { radiance, over_cosine };

constexpr std::size_t block_samples = 256;

/// Every pair of two samplings, [view][light], filled up to whole blocks.
struct Samples {
  Samples(const HemisphereSampling& views, const HemisphereSampling& lights, Quantity quantity);

  std::size_t pairs = 0;  ///< of the data
  std::size_t count = 0;  ///< with those that fill the last block
  std::size_t blocks() const { return count / block_samples; }

  // [count] each.
  std::vector<float> light[3];  // NOLINT: x, y, z
  std::vector<float> view[3];   // NOLINT
  std::vector<float> cosine;    ///< between light and view
  /// What the sum is multiplied by to give B: 1 or cos(theta_light); 0 below the horizon and where
  /// it fills up.
  std::vector<float> gain;
};

/// One texel's B, as the loops want it: [rgb][count], over `scale`, 0 where the gain is.
/// @param abrdf  [pair][rgb].
std::vector<float> channel_arrays(const Samples& samples, std::span<const float> abrdf,
                                  double scale);

}  // namespace weft::srbf
