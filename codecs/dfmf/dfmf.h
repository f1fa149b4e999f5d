// Decorrelated full-matrix factorisation: log-luminance and two chromas, each by its own singular
// value decomposition of the whole BTF. What the UBO2014 database's files hold.
//
// Schwartz, Sarlette, Weinmann and Klein: DOME II, Workshop on Material Appearance Modeling 2013;
// Müller: Data-driven Methods for Compression and Editing of Spatially Varying Appearance, 2009.
#pragma once

#include "codecs/representation.h"

namespace weft {

/// The registry's row for `dfmf`.
Codec dfmf_codec();

}  // namespace weft
