// Levels of detail: a Laplacian pyramid of each BTF image, and principal components of each level's
// Laplacian BRDFs.
//
// Paper 000 (Level-of-Detail Representation of Bidirectional Texture Functions for Real-Time
// Rendering). Its omega_i is our light, its omega_o our view, its p our texel, its lambda our lod.
#pragma once

#include "codecs/representation.h"

namespace weft {

/// The registry's row for `laplacian`.
Codec laplacian_codec();

}  // namespace weft
