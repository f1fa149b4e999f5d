// Clusters that are there are found, and the randomness is the seed's alone.

#include "codecs/cmf/k_means.h"

#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

using namespace weft;
using namespace weft::cmf;

namespace {

/// `clusters` well separated groups of 20 rows each, a little spread within.
RowMatrix groups(int clusters) {
  RowMatrix data(20 * clusters, 40);
  for (Eigen::Index r = 0; r < data.rows(); ++r) {
    for (Eigen::Index c = 0; c < data.cols(); ++c) {
      const auto centre = static_cast<double>(r % clusters + 1);
      data(r, c) = static_cast<float>(std::sin(centre * (c + 1)) + 0.01 * std::sin(37.0 * r + c));
    }
  }
  return data;
}

double squared_error(const RowMatrix& data, const Clustering& clustering) {
  double sum = 0;
  for (Eigen::Index r = 0; r < data.rows(); ++r) {
    sum += (data.row(r) - clustering.prototypes.row(clustering.index[r])).squaredNorm();
  }
  return sum;
}

}  // namespace

TEST_CASE("k-means finds separated groups, for any seed") {
  const RowMatrix data = groups(12);
  for (const std::uint64_t seed : {0, 1, 2, 3, 4}) {
    Progress progress;
    const Clustering clustering = k_means(data, 12, seed, progress);
    for (Eigen::Index r = 0; r < data.rows(); ++r) {
      CHECK(clustering.index[r] == clustering.index[r % 12]);
    }
    CHECK(std::set(clustering.index.begin(), clustering.index.end()).size() == 12);
    CHECK(squared_error(data, clustering) < 240 * 40 * 1e-4);
  }
}

TEST_CASE("k-means makes fewer clusters where rows repeat, and is exact then") {
  RowMatrix data = groups(5);
  for (Eigen::Index r = 5; r < data.rows(); ++r) data.row(r) = data.row(r % 5);
  Progress progress;
  const Clustering clustering = k_means(data, 256, 7, progress);
  CHECK(clustering.prototypes.rows() == 5);
  CHECK(squared_error(data, clustering) < 1e-9);
}

TEST_CASE("k-means gets better with more clusters, and one cluster is the mean") {
  const RowMatrix data = groups(20);
  double previous = 1e9;
  for (const int clusters : {1, 2, 4, 8, 16}) {
    Progress progress;
    const Clustering clustering = k_means(data, clusters, 0, progress);
    const double error = squared_error(data, clustering);
    CHECK(error < previous);
    previous = error;
    if (clusters == 1) {
      CHECK((clustering.prototypes.row(0) - data.colwise().mean()).norm() < 1e-4);
    }
  }
}

TEST_CASE("k-means is the same for one thread and for two") {
  const RowMatrix data = groups(70);
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Progress progress;
    return k_means(data, 32, 0, progress);
  };
  const Clustering one = run(1);
  const Clustering two = run(2);
  CHECK(one.index == two.index);
  CHECK(one.prototypes == two.prototypes);
}
