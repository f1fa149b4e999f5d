// How far a representation is from the data it was fitted to, at the data's own samples.
#pragma once

#include "btf/btf.h"
#include "codecs/representation.h"

namespace weft {

struct SampleError {
  double rmse = 0;           ///< over all texels, pairs and channels, 1/sr
  double relative_rmse = 0;  ///< rmse over the root mean square of the data; 0 where both are 0
  /// Mean of |difference of luminances| (Rec. 709), over the mean luminance of the data; 0 where
  /// both are 0.
  double luminance_difference = 0;
};

/// Evaluates every (texel centre, light, view) at level 0. Samples whose light or view lies on the
/// horizon are left out: there `evaluate` is 0 by definition.
SampleError sample_error(const Btf& btf, const Representation& representation);

}  // namespace weft
