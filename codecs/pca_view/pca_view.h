// Principal components of each view alone: its own eigen-images over the lights, and its own
// weights of each texel.
//
// Sattler, Sarlette and Klein: Efficient and Realistic Visualization of Cloth, Eurographics
// Symposium on Rendering 2003. Their weights' images are our [set][texel], a set a view.
#pragma once

#include "codecs/representation.h"

namespace weft {

/// The registry's row for `pca-view`.
Codec pca_view_codec();

}  // namespace weft
