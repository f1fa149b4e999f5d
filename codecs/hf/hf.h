// Homomorphic factorisation: each texel's ABRDF as a product of maps over light, half-vector and
// view, all found at once in the logarithm.
//
// McCool, Ang, Ahmad: Homomorphic Factorization of BRDFs for High-Performance Rendering, SIGGRAPH
// 2001, as told in section 4.3 of "paper 004" (see cmf/cmf.h).
#pragma once

#include "codecs/representation.h"

namespace weft {

Codec hf_codec();

}  // namespace weft
