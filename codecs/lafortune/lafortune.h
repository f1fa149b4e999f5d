// The codec `lafortune`: a Lafortune model a texel, which paper 003 compares its lobes with.
#pragma once

#include "codecs/representation.h"

namespace weft {

Codec lafortune_codec();

}  // namespace weft
