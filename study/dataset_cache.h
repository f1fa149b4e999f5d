// Datasets that benches measure, traced once and kept.
#pragma once

#include <filesystem>

#include "acquisition/acquire.h"
#include "btf/progress.h"

namespace weft {

/// $XDG_CACHE_HOME/weft where that is an absolute path (as its specification asks), else
/// ~/.cache/weft. @throws Error  bad_input where neither variable says where.
std::filesystem::path cache_folder();

/// The dataset of these settings in `cache`: its name is a hash of `provenance_of` them, so that
/// other settings have another folder. It is traced where it is not there yet; a tracing that was
/// interrupted is continued.
std::filesystem::path cached_dataset(const std::filesystem::path& cache,
                                     const Mesostructure& mesostructure,
                                     const AcquisitionSettings& settings, Progress& progress);

}  // namespace weft
