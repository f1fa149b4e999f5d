// From a mesostructure to a raw BTF, in memory or as a dataset on disk.
#pragma once

#include <filesystem>
#include <string>

#include "acquisition/view_tracer.h"
#include "btf/btf.h"
#include "btf/progress.h"

namespace weft {

struct AcquisitionSettings {
  TraceSettings trace;
  std::string views = "ubo81";  ///< a name that `named_directions` knows
  std::string lights = "ubo81";
  PixelType pixel_type = PixelType::half;
};

struct AcquisitionReport {
  TraceStatistics statistics;
  double seconds = 0;          ///< tracing and writing
  std::size_t views_kept = 0;  ///< were there already
  std::size_t lights = 0;
};

/// Traces every view that `folder` does not hold yet, and finishes the dataset. The same settings
/// give the same bytes.
/// @throws Error  where the folder holds another dataset, a direction is too low, or the disk is
/// full.
AcquisitionReport acquire(const Mesostructure& mesostructure, const AcquisitionSettings& settings,
                          const std::filesystem::path& folder, Progress& progress);

/// The same into memory.
Btf acquire(const Mesostructure& mesostructure, const AcquisitionSettings& settings);

/// What a dataset's provenance says: canonical JSON of the settings that decide its values.
std::string provenance_of(const Mesostructure& mesostructure, const AcquisitionSettings& settings);

}  // namespace weft
