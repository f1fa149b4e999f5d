// Clusters that are there are found, and the randomness is the seed's alone.

#include "codecs/factor_maps/clustering.h"

#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <vector>

using namespace weft;
using namespace weft::factor_maps;

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

std::vector<double> alike(const RowMatrix& data) {
  return std::vector<double>(static_cast<std::size_t>(data.rows()), 1.0);
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
    const Clustering clustering = k_means(data, alike(data), 12, seed, Prototypes::means, progress);
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
  const Clustering clustering = k_means(data, alike(data), 256, 7, Prototypes::means, progress);
  CHECK(clustering.prototypes.rows() == 5);
  CHECK(squared_error(data, clustering) < 1e-9);
}

TEST_CASE("k-means gets better with more clusters, and one cluster is the mean") {
  const RowMatrix data = groups(20);
  double previous = 1e9;
  for (const int clusters : {1, 2, 4, 8, 16}) {
    Progress progress;
    const Clustering clustering =
        k_means(data, alike(data), clusters, 0, Prototypes::means, progress);
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
    return k_means(data, alike(data), 32, 0, Prototypes::means, progress);
  };
  const Clustering one = run(1);
  const Clustering two = run(2);
  CHECK(one.index == two.index);
  CHECK(one.prototypes == two.prototypes);
}

TEST_CASE("Both methods and both metrics find separated groups") {
  const RowMatrix data = groups(12);
  for (const ClusterMethod method : {ClusterMethod::k_means, ClusterMethod::tree}) {
    for (const ClusterMetric metric : {ClusterMetric::euclidean, ClusterMetric::cosine}) {
      Progress progress;
      const Codebook book = cluster(data, alike(data), {method, metric, 12, 0}, progress);
      const auto& index = book.clustering.index;
      CHECK(std::set(index.begin(), index.end()).size() == 12);
      double error = 0;
      for (Eigen::Index r = 0; r < data.rows(); ++r) {
        CHECK(index[r] == index[r % 12]);
        const Eigen::RowVectorXf answer =
            book.clustering.prototypes.row(index[r]) * book.amplitude[r];
        error += (data.row(r) - answer).squaredNorm();
      }
      CHECK(error < 240 * 40 * 1e-4);
    }
  }
}

TEST_CASE("By angle, rows that differ in length alone are one cluster") {
  RowMatrix data(30, 40);
  for (Eigen::Index r = 0; r < 30; ++r) {
    data.row(r) = groups(3).row(r % 3) * static_cast<float>(1 + r * r);
  }
  Progress progress;
  const Codebook by_angle =
      cluster(data, alike(data), {ClusterMethod::k_means, ClusterMetric::cosine, 3, 1}, progress);
  const Codebook by_distance = cluster(
      data, alike(data), {ClusterMethod::k_means, ClusterMetric::euclidean, 3, 1}, progress);
  bool distance_splits = false;
  for (Eigen::Index r = 0; r < 30; ++r) {
    CHECK(by_angle.clustering.index[r] == by_angle.clustering.index[r % 3]);
    const Eigen::RowVectorXf answer =
        by_angle.clustering.prototypes.row(by_angle.clustering.index[r]) * by_angle.amplitude[r];
    CHECK((data.row(r) - answer).norm() < 1e-3 * data.row(r).norm());
    distance_splits =
        distance_splits || by_distance.clustering.index[r] != by_distance.clustering.index[r % 3];
  }
  CHECK(distance_splits);
}

TEST_CASE("A tree of equal rows is one exact cluster, and black rows do no harm") {
  for (const float value : {0.0F, 3.0F}) {
    const RowMatrix data = RowMatrix::Constant(20, 7, value);
    for (const ClusterMetric metric : {ClusterMetric::euclidean, ClusterMetric::cosine}) {
      Progress progress;
      const Codebook book =
          cluster(data, alike(data), {ClusterMethod::tree, metric, 8, 0}, progress);
      CHECK(book.clustering.prototypes.rows() == 1);
      CHECK((book.clustering.prototypes.row(0) * book.amplitude[5] - data.row(5)).norm() < 1e-5);
    }
  }
}

TEST_CASE("A row counts as its weight, by either method and metric") {
  // Two far groups of two rows; a third cluster is spent where the weight is.
  RowMatrix data(4, 3);
  data << 10, 0, 0, 10, 1, 0, 0, 10, 0, 0, 10, 1;
  for (const ClusterMethod method : {ClusterMethod::k_means, ClusterMethod::tree}) {
    for (const ClusterMetric metric : {ClusterMetric::euclidean, ClusterMetric::cosine}) {
      for (const bool first : {true, false}) {
        const double a = first ? 1e9 : 1;
        const double b = first ? 1 : 1e9;
        Progress progress;
        const auto index =
            cluster(data, {a, a, b, b}, {method, metric, 3, 0}, progress).clustering.index;
        CHECK((index[0] == index[1]) == !first);
        CHECK((index[2] == index[3]) == first);
      }
    }
  }
  Progress progress;
  const Clustering one = k_means(data, {3, 1, 0, 0}, 1, 0, Prototypes::means, progress);
  CHECK((one.prototypes.row(0) - Eigen::RowVector3f(10, 0.25F, 0)).norm() < 1e-5F);
}
