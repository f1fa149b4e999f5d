// The plain way to trace one pair of directions: what the fast one is held against.
#pragma once

#include <cstdint>
#include <vector>

#include "acquisition/view_tracer.h"

namespace weft {

struct NaiveEstimate {
  std::vector<double> values;     ///< [y][x][rgb], B in 1/sr
  std::vector<double> variances;  ///< of those means, from the samples' spread; of `spp` > 1
  std::int64_t rays = 0;
};

/// Path by path, with single rays and plain random numbers, one light at a time: no packets, no
/// table, nothing shared between lights. The same quantity, scene and end of paths as `ViewTracer`.
/// @param key  names the pair in the random numbers. Deterministic for any number of threads.
NaiveEstimate trace_pair_naively(const TraceableStructure& structure, const TraceSettings& settings,
                                 const Direction& view, const Direction& light, std::uint64_t key);

}  // namespace weft
