// Codebooks of maps: k-means or a tree of bisections, by Euclidean distance or by angle.
#pragma once

#include "codecs/factor_maps/k_means.h"

namespace weft::factor_maps {

/// `k_means`: Lloyd's iterations from k-means++ seeds. `tree`: the cluster of the largest error is
/// cut in two by 2-means, until there are enough.
enum class ClusterMethod { k_means, tree };
/// `cosine`: rows are alike where they point alike, whatever their lengths.
enum class ClusterMetric { euclidean, cosine };

struct ClusterOptions {
  ClusterMethod method = ClusterMethod::k_means;
  ClusterMetric metric = ClusterMetric::euclidean;
  int clusters = 256;  ///< at most; 1 to 65,536
  std::uint64_t seed = 0;
};

struct Codebook {
  Clustering clustering;
  /// What a row's prototype is to be multiplied by to be nearest to the row; all 1 with the
  /// Euclidean metric. With `cosine` a prototype's largest magnitude is 1.
  std::vector<float> amplitude;
};

/// @param rows     [map][value]; scaled to length 1 with the cosine metric.
/// @param weights  what a row's squared error counts, >= 0.
/// The same for any number of threads.
Codebook cluster(LargeRows rows, std::vector<double> weights, const ClusterOptions& options,
                 Progress& progress);

}  // namespace weft::factor_maps
