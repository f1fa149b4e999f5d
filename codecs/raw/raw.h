// Codec zero: the raw BTF itself, every sample kept, with its mip chain as levels of detail.
#pragma once

#include "codecs/representation.h"

namespace weft {

/// The registry's row for `raw`.
Codec raw_codec();

}  // namespace weft
