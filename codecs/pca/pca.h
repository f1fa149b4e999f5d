// Principal components of the whole BTF: eigen-ABRDFs that all texels share, and each texel's
// weights.
//
// A full-matrix factorisation, as Koudelka et al. (Texture 2003) and Liu et al. (2004) use; the
// rows are the texels' ABRDFs, the columns all (view, light, rgb). Colour stays in the columns:
// what the channels share is found by the PCA itself, and a texel's weights serve all three.
#pragma once

#include "codecs/representation.h"

namespace weft {

/// The registry's row for `pca`.
Codec pca_codec();

}  // namespace weft
