// A homogeneous isotropic material (Lambert, conductor, plastic) as a table that the GPU
// interpolates.
//
// f = B / cos(theta_light) is tabulated over Rusinkiewicz' half-angle coordinates (theta_half,
// theta_diff, phi_diff) [Rusinkiewicz 1998], theta_half on a square-root scale, so that the
// highlight of a smooth material gets most of the entries. A Lambert material is exact; a highlight
// of alpha 0.1 is within about 1 % of its peak.
#pragma once

#include "btf/appearance.h"
#include "codecs/gl_program.h"

namespace weft {

/// @param material  homogeneous, isotropic, reciprocal; asked at (0, 0) and lod 0.
GlProgram tabulated_program(const Appearance& material);

}  // namespace weft
