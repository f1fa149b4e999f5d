// Chained matrix factorisation: each texel's ABRDF as a product of maps over light, half-vector and
// view, clustered.
//
// Suykens, vom Berge, Lagae, Dutre: Interactive Rendering with Bidirectional Texture Functions,
// Eurographics 2003
// ("paper 004"). Its wi is our light, its wo our view; the light's cosine is divided out before and
// multiplied after.
#pragma once

#include "codecs/representation.h"

namespace weft {

/// The registry's row for `cmf`.
Codec cmf_codec();

}  // namespace weft
