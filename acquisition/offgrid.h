// Pairs of directions between those of a dataset: what interpolation and codecs are judged by
// there.
#pragma once

#include <filesystem>

#include "acquisition/acquire.h"

namespace weft {

/// Traces `count` random pairs into FOLDER/offgrid/: pair_000.exr ..., each a view's file with one
/// light, in floats, and offgrid.json, which comes last. View and light are drawn evenly over the
/// solid angle down to the lowest direction that the dataset has of each; pair i is the same
/// whatever the count. Pairs that are there already, of the same settings, are kept.
/// @throws Error  as `acquire`.
AcquisitionReport acquire_offgrid(const Mesostructure& mesostructure,
                                  const AcquisitionSettings& settings, std::size_t count,
                                  const std::filesystem::path& folder, Progress& progress);

}  // namespace weft
