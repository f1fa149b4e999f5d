// The codec `lobes`: luminance over the lights as a sum of lobes for each measured view and texel
// (paper 003).
#pragma once

#include "codecs/representation.h"

namespace weft {

Codec lobes_codec();

}  // namespace weft
