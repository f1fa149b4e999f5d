// What codecs cost (time to fit and to decode, bytes, memory) and lose, measured on one dataset.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "btf/appearance.h"
#include "btf/btf.h"
#include "btf/progress.h"
#include "codecs/representation.h"

namespace weft {

/// Nanoseconds a query, on one thread.
struct DecodeTimes {
  double single = 0;   ///< `evaluate` of one query after the other
  double batched = 0;  ///< one `evaluate` of all of them
};

/// Queries of one level of detail, the same each time (hashes): places even over the tile, lights
/// and views even over the solid angle of the hemisphere, none of them on the horizon.
std::vector<AppearanceQuery> decode_queries(std::size_t count = 1024, float lod = 0);

/// The time of a pass over `queries` over their number; of 301 passes each way, taken in turn after
/// one that is not counted, the median.
/// @param queries  at least one.
DecodeTimes decode_times(const Appearance& appearance, std::span<const AppearanceQuery> queries);

/// What a level of detail costs and loses between the samples, too.
struct LevelBench {
  float lod = 0;
  DecodeTimes decode;
  double relative_rmse = 0;  ///< over 16,384 queries, against the raw BTF's answers at the same lod
};

struct CodecBench {
  double fit_seconds = 0;  ///< of the wall, all threads
  DecodeTimes decode;
  double rmse = 0;                  ///< as `sample_error`, 1/sr
  double relative_rmse = 0;         ///< of the data's root mean square
  double luminance_difference = 0;  ///< as `sample_error`
  std::size_t texels = 0;           ///< of the tile
  std::size_t bytes = 0;            ///< of textures
  std::size_t constant_bytes = 0;
  double ratio = 0;  ///< `compression_ratio`
  /// The largest resident set during the fit, what the process held before left out and the raw
  /// data counted in, over the raw data's bytes. 1: nothing but the raw data. Nothing where the
  /// system does not tell.
  std::optional<double> fit_memory;
  /// Of lod 0, 0.5, 1, 2, ... to the tile as one texel; one where the codec has no levels.
  std::vector<LevelBench> levels;
};

/// @param parameters  "KEY=VALUE", as `compress --set`.
/// @throws Error  as the codec's fit.
CodecBench bench_codec(const Codec& codec, const std::vector<std::string>& parameters,
                       const std::shared_ptr<const Btf>& btf, Progress& progress);

}  // namespace weft
