// k-means clustering of long vectors: k-means++ seeds, Lloyd's iterations, Euclidean metric.
#pragma once

#include <cstdint>
#include <vector>

#include "btf/progress.h"
#include "codecs/factor_maps/large_rows.h"

namespace weft::factor_maps {

struct Clustering {
  RowMatrix prototypes;              ///< a row a cluster
  std::vector<std::uint16_t> index;  ///< cluster of each row of the data
};

/// What stands for a cluster: the weighted mean of its rows, or that scaled to length 1.
enum class Prototypes { means, directions };

/// At most `clusters` clusters (1 to 65,536); fewer where the data has fewer distinct rows, and
/// then exact. The same for any number of threads; randomness is a hash of `seed`. `progress` is
/// advanced once an iteration.
/// With `Prototypes::directions` rows are to be of length 1 (or 0).
/// @param weights  what a row's squared error counts, >= 0.
Clustering k_means(const Rows& data, const std::vector<double>& weights, int clusters,
                   std::uint64_t seed, Prototypes kind, Progress& progress);

/// Upper bound of the iterations, for `Progress::start`.
constexpr int max_k_means_iterations = 30;

}  // namespace weft::factor_maps
