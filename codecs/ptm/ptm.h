// The codec `ptm`: a polynomial texture map for each measured view, which paper 003 compares its
// lobes with.
#pragma once

#include "codecs/representation.h"

namespace weft {

Codec ptm_codec();

}  // namespace weft
