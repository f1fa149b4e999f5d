// Sums of multivariate spherical radial basis functions, whose variables are fitted too, at every
// mip level.
//
// Paper 001 (multivariate SRBFs with optimal reparameterisation). Its eta_i is our light, its eta_o
// our view.
#pragma once

#include "codecs/representation.h"

namespace weft {

/// The registry's row for `srbf`.
Codec srbf_codec();

}  // namespace weft
