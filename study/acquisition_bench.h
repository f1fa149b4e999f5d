// How fast acquisition is, against Embree alone and against the plain way.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/acquire.h"
#include "btf/progress.h"
#include "study/bar.h"

namespace weft {

/// What the cache of indirect light (`TraceSettings::indirect_cache`) gains and how far it is off.
struct IndirectCacheBench {
  double full_dataset_seconds = 0;  ///< from the structure to the written dataset
  double samples_per_second = 0;
  /// Of the tile's mean of a pair, relative, over some pairs: its mean (the bias), the root of its
  /// mean square, and the standard error of one of them, that of the unbiased side included.
  double bias = 0;
  double rms_difference = 0;
  double standard_error = 0;
};

/// What one structure's acquisition takes. Times are of the wall, with all threads.
struct AcquisitionBench {
  std::string structure;
  bool lambert = false;             ///< every material
  double full_dataset_seconds = 0;  ///< from the structure to the written dataset
  double samples_per_second = 0;    ///< texel x pair x spp
  double rays_per_second = 0;       ///< really traced
  TraceStatistics statistics;
  /// What Embree alone needs for every primary, bounce and visibility query that the estimator asks
  /// (traced, or answered by the table), each kind in its fastest form of call.
  double embree_seconds = 0;
  double roofline_ratio = 0;  ///< embree_seconds / full_dataset_seconds
  std::string primary_form;   ///< the fastest form of each kind
  std::string bounce_form;
  std::string first_shadow_form;
  std::string later_shadow_form;
  /// Time x mean square error of the plain way (`trace_pair_naively`) over ours, for a pair.
  double speedup_equal_rmse = 0;
  double naive_seconds_a_pair = 0;                   ///< at `naive_spp`
  double naive_rmse = 0;                             ///< over texels and some pairs, 1/sr
  double rmse = 0;                                   ///< ours, of the same pairs
  std::optional<IndirectCacheBench> indirect_cache;  ///< where the structure can have it
};

inline constexpr int naive_bench_spp = 16;

/// Traces the whole dataset into `folder`, which is removed again, with and without the cache of
/// indirect light, then measures the rest on parts.
AcquisitionBench bench_acquisition(const std::string& name, const Mesostructure& mesostructure,
                                   const AcquisitionSettings& settings,
                                   const std::filesystem::path& folder, Progress& progress);

/// What two cores are to reach on 64 x 64 texels, ubo81 and 64 spp: more where all is Lambert.
std::vector<Bar> acquisition_bars(const AcquisitionBench& bench);

/// One row of the table of costs: seconds of a whole dataset with one size multiplied.
struct AcquisitionCost {
  std::string size;  ///< texels (a side's square), spp, views or lights
  int factor = 1;
  double seconds = 0;  ///< from the structure to the written dataset, the least of three runs
};

/// How the time grows with each size: 1, 2 and 4 times a quarter of what `settings` say, the others
/// held. As many directions as theirs, but evenly spread (`fibonacci`). `folder` is removed again.
std::vector<AcquisitionCost> acquisition_costs(const Mesostructure& mesostructure,
                                               const AcquisitionSettings& settings,
                                               const std::filesystem::path& folder,
                                               Progress& progress);

/// Time grows no faster than linearly, and clearly slower with lights.
/// @param costs  as `acquisition_costs` returns them.
std::vector<Bar> cost_bars(const std::vector<AcquisitionCost>& costs);

}  // namespace weft
