// k-means clustering of long vectors: k-means++ seeds, Lloyd's iterations, Euclidean metric.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "btf/progress.h"

namespace weft::cmf {

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Clustering {
  RowMatrix prototypes;              ///< the mean of each cluster, a row each
  std::vector<std::uint16_t> index;  ///< cluster of each row of the data
};

/// At most `clusters` clusters (1 to 65,536); fewer where the data has fewer distinct rows, and
/// then exact. The same for any number of threads; randomness is a hash of `seed`. `progress` is
/// advanced once an iteration.
Clustering k_means(const RowMatrix& data, int clusters, std::uint64_t seed, Progress& progress);

/// Upper bound of the iterations, for `Progress::start`.
constexpr int max_k_means_iterations = 30;

}  // namespace weft::cmf
