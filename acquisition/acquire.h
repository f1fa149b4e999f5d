// From a mesostructure to a raw BTF, in memory or as a dataset on disk.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/view_tracer.h"
#include "btf/btf.h"
#include "btf/progress.h"

namespace weft {

struct AcquisitionSettings {
  TraceSettings trace;
  std::string views = "ubo81";  ///< a name that `named_directions` knows
  std::string lights = "ubo81";
  PixelType pixel_type = PixelType::half;
  /// Bytes that the process may hold; fewer views are traced at once where they would not fit. 0:
  /// as many as there are threads.
  std::size_t memory = 0;
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

/// A part of a dataset's views: those whose number v has v % count == index.
struct Shard {
  std::size_t index = 0;
  std::size_t count = 1;
};

/// Traces those of the shard's views that `folder` does not hold yet; the JSON is left to
/// `finish_acquisition`. Shards may run at once in one folder, on several machines, and again.
AcquisitionReport acquire_shard(const Mesostructure& mesostructure,
                                const AcquisitionSettings& settings, const Shard& shard,
                                const std::filesystem::path& folder, Progress& progress);

/// Finishes a dataset whose views shards have traced. Returns the views that are missing; where
/// there are any, nothing is written. @throws Error where the folder holds another dataset.
std::vector<std::size_t> finish_acquisition(const Mesostructure& mesostructure,
                                            const AcquisitionSettings& settings,
                                            const std::filesystem::path& folder);

/// The whole dataset into memory.
Btf acquire(const Mesostructure& mesostructure, const AcquisitionSettings& settings);

/// What a dataset's provenance says: canonical JSON of the settings that decide its values.
std::string provenance_of(const Mesostructure& mesostructure, const AcquisitionSettings& settings);

}  // namespace weft
