// The types of mesostructures, one a source file of this folder.
#pragma once

#include "acquisition/mesostructure.h"

namespace weft {

MesostructureType checker_type();
MesostructureType rings_type();
MesostructureType tissue_type();
MesostructureType weave_type();
MesostructureType knit_type();
MesostructureType corduroy_type();
MesostructureType leather_type();
MesostructureType gravel_type();
MesostructureType brick_type();
MesostructureType heightfield_type();
MesostructureType mesh_type();

}  // namespace weft
