// Refuses data that is no reflectance, before it is fitted.
#pragma once

#include "btf/btf.h"

namespace weft {

/// @throws Error  naming view, light and texel of the first value (by texels, then views) that is
///                not finite and >= 0.
void refuse_invalid_samples(const Btf& btf);

}  // namespace weft
