#include "codecs/factor_maps/clustering.h"

#include <algorithm>
#include <utility>

namespace weft::factor_maps {

namespace {

using Index = Eigen::Index;

using Weights = std::vector<double>;

struct Node {
  std::vector<Index> rows;
  Eigen::RowVectorXf mean;  // weighted
  double error = 0;         // sum of weighted squared distances to the mean
};

LargeRows rows_of(const LargeRows& data, const std::vector<Index>& rows) {
  LargeRows part(static_cast<Index>(rows.size()), data.matrix().cols(), data.memory());
  for (std::size_t i = 0; i < rows.size(); ++i)
    part.matrix().row(static_cast<Index>(i)) = data.matrix().row(rows[i]);
  return part;
}

Node node_of(const Rows& data, const Weights& weights, std::vector<Index> rows) {
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(data.cols());
  double weight = 0;
  for (const Index r : rows) {
    sum += weights[r] * data.row(r).cast<double>();
    weight += weights[r];
  }
  Node node{std::move(rows), {}, 0};
  node.mean = data.row(node.rows[0]);
  if (weight > 0) node.mean = (sum / weight).cast<float>();
  for (const Index r : node.rows) {
    node.error += weights[r] * (data.row(r) - node.mean).squaredNorm();
  }
  return node;
}

// Empty halves where all rows are equal.
std::pair<std::vector<Index>, std::vector<Index>> halves(const LargeRows& data,
                                                         const Weights& weights, const Node& node,
                                                         std::uint64_t seed) {
  Progress silent;
  Weights own;
  for (const Index r : node.rows) own.push_back(weights[r]);
  const Clustering two =
      k_means(rows_of(data, node.rows).matrix(), own, 2, seed, Prototypes::means, silent);
  std::pair<std::vector<Index>, std::vector<Index>> parts;
  for (std::size_t i = 0; i < node.rows.size(); ++i) {
    (two.index[i] == 0 ? parts.first : parts.second).push_back(node.rows[i]);
  }
  return parts;
}

Clustering tree(const LargeRows& rows, const Weights& weights, int clusters, std::uint64_t seed) {
  const Rows data = rows.matrix();
  std::vector<Index> all(data.rows());
  for (Index r = 0; r < data.rows(); ++r) all[r] = r;
  std::vector<Node> leaves{node_of(data, weights, std::move(all))};
  while (static_cast<int>(leaves.size()) < clusters) {
    const auto worst = std::ranges::max_element(leaves, {}, &Node::error);
    if (!(worst->error > 0)) break;
    auto [left, right] = halves(rows, weights, *worst, seed + leaves.size());
    if (left.empty() || right.empty()) {  // differences that rounding hides
      worst->error = 0;
      continue;
    }
    *worst = node_of(data, weights, std::move(left));
    leaves.push_back(node_of(data, weights, std::move(right)));
  }
  Clustering result{RowMatrix(leaves.size(), data.cols()), {}};
  result.index.resize(data.rows());
  for (std::size_t c = 0; c < leaves.size(); ++c) {
    result.prototypes.row(c) = leaves[c].mean;
    for (const Index r : leaves[c].rows) result.index[r] = static_cast<std::uint16_t>(c);
  }
  return result;
}

}  // namespace

Codebook cluster(LargeRows large, std::vector<double> weights, const ClusterOptions& options,
                 Progress& progress) {
  Eigen::Map<RowMatrix> rows = large.matrix();
  const bool cosine = options.metric == ClusterMetric::cosine;
  Eigen::VectorXf norms;
  if (cosine) {
    norms = rows.rowwise().norm();
    for (Index r = 0; r < rows.rows(); ++r) {
      if (!(norms[r] > 0)) continue;
      rows.row(r) /= norms[r];
      weights[r] *= static_cast<double>(norms[r]) * norms[r];
    }
  }
  Codebook book;
  book.clustering = options.method == ClusterMethod::tree
                        ? tree(large, weights, options.clusters, options.seed)
                        : k_means(rows, weights, options.clusters, options.seed,
                                  cosine ? Prototypes::directions : Prototypes::means, progress);
  book.amplitude.assign(rows.rows(), 1.0F);
  if (!cosine) return book;
  RowMatrix& prototypes = book.clustering.prototypes;
  for (Index c = 0; c < prototypes.rows(); ++c) {
    const float largest = prototypes.row(c).cwiseAbs().maxCoeff();
    if (largest > 0) prototypes.row(c) /= largest;
  }
  for (Index r = 0; r < rows.rows(); ++r) {
    const auto prototype = prototypes.row(book.clustering.index[r]);
    const float square = prototype.squaredNorm();
    book.amplitude[r] = square > 0 ? norms[r] * rows.row(r).dot(prototype) / square : 0.0F;
  }
  return book;
}

}  // namespace weft::factor_maps
