// Codebooks and index maps improved together, against the data: what k-means of each factor alone
// makes of the other factors' errors is not asked, and what is seen of a map's error neither.
#pragma once

#include "btf/progress.h"
#include "codecs/factor_maps/model.h"
#include "codecs/factor_maps/texel_source.h"

namespace weft::factor_maps {

/// Lowers  sum over texels, pairs and channels of (B - S P Q R cos(theta_l))^2  in `rounds` rounds,
/// each of which takes every factor in turn: each texel is given the map of the codebook whose
/// error, with the best S and the other factors as they are, is least; and each map becomes the
/// least squares answer for all texels that use it, kept >= 0. Texels of all levels count alike.
///
/// @param model  clustered, one term a link, maps in floats; its scale is not read. Codebooks and
///               index change. The same for any number of threads.
void refine_codebooks(const TexelSource& source, int rounds, Model& model, Progress& progress);

}  // namespace weft::factor_maps
