// The fast estimator held against the plain one, texel by texel and pair by pair.
#pragma once

#include <cstdint>

#include "acquisition/mesostructure.h"

namespace weft::test {

struct Agreement {
  double mean_square_z = 0;   ///< 1 where errors are told rightly, less where conservatively
  double outside = 0;         ///< share of |z| > 4: chance has 6e-5
  double difference = 0;      ///< of the means over all, relative
  double deviation = 0;       ///< standard error of that difference, relative
  double largest_pair_z = 0;  ///< |z| of a pair's mean over the tile, a channel
  std::int64_t open_bounces = 0;
};

/// Three views and two lights, 16 x 16 texels, with a visibility table where there are triangles.
/// Values of one path's channels move together, so the mean's variance is taken three times.
Agreement agreement(const Mesostructure& mesostructure, int naive_spp, int spp);

}  // namespace weft::test
