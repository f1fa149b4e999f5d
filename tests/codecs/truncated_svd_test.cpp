// The truncated SVD against Eigen's full one, and where a matrix is ill-conditioned.

#include "codecs/truncated_svd.h"

#include <tbb/global_control.h>

#include <Eigen/SVD>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>

#include "btf/random.h"

using namespace weft;

namespace {

using RowMatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

RowSource source_of(const RowMatrixXf& m) {
  return {static_cast<std::size_t>(m.rows()), static_cast<std::size_t>(m.cols()),
          [&m](std::size_t first, std::size_t count, float* values) {
            std::copy_n(m.data() + first * m.cols(), count * m.cols(), values);
          }};
}

RowMatrixXf noise(int rows, int columns, int seed) {
  RowMatrixXf m(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) m(i, j) = unit_float(hash_coordinates(seed, i, j)) - 0.5F;
  }
  return m;
}

// Singular values that fall as `decay`^k, noise of 1e-3 of the first below.
RowMatrixXf decaying(int rows, int columns, double decay) {
  const int n = std::min(rows, columns);
  Eigen::MatrixXf scaled = noise(rows, n, 1);
  for (int k = 0; k < n; ++k) scaled.col(k) *= static_cast<float>(std::pow(decay, k));
  return scaled * noise(n, columns, 2) + 1e-3F * noise(rows, columns, 3);
}

TruncatedSvdOptions components(std::size_t count, bool centred = false) {
  TruncatedSvdOptions options;
  options.components = count;
  options.centred = centred;
  return options;
}

Eigen::MatrixXd rebuilt(const TruncatedSvd& svd) {
  Eigen::MatrixXd m = svd.left * svd.singular.asDiagonal() * svd.right.transpose();
  m.rowwise() += svd.mean.transpose();
  return m;
}

double error(const RowMatrixXf& m, const TruncatedSvd& svd) {
  return (m.cast<double>() - rebuilt(svd)).norm();
}

// Eckart and Young: the root of the squares of the singular values that are left out.
double least_error(Eigen::MatrixXd m, std::size_t count, bool centred) {
  if (centred) m.rowwise() -= m.colwise().mean().eval();
  const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(m).singularValues();
  return values.tail(std::max<Eigen::Index>(0, values.size() - static_cast<Eigen::Index>(count)))
      .norm();
}

double departure_from_orthonormal(const Eigen::MatrixXd& m) {
  return (m.transpose() * m - Eigen::MatrixXd::Identity(m.cols(), m.cols())).cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("A truncated SVD is within 1 percent of the best there is") {
  for (const double decay : {0.5, 0.9, 0.99, 1.0}) {
    for (const auto& [rows, columns] : {std::pair(90, 130), std::pair(130, 90)}) {
      const RowMatrixXf m = decaying(rows, columns, decay);
      for (const std::size_t count : {1, 4, 16}) {
        for (const bool centred : {false, true}) {
          const TruncatedSvd svd = truncated_svd(source_of(m), components(count, centred));
          const double best = least_error(m.cast<double>(), count, centred);
          INFO("decay " << decay << ", " << rows << " x " << columns << ", " << count
                        << " components, centred " << centred);
          CHECK(error(m, svd) <= 1.01 * best);
          CHECK(error(m, svd) >= best * (1 - 1e-9));
          CHECK(departure_from_orthonormal(svd.left) < 1e-12);
          CHECK(departure_from_orthonormal(svd.right) < 1e-12);
        }
      }
    }
  }
}

TEST_CASE("A truncated SVD of rank 1, zero, repeated columns and few rows") {
  const Eigen::VectorXf a = noise(40, 1, 5).col(0);
  const Eigen::VectorXf b = noise(70, 1, 6).col(0);
  const RowMatrixXf rank_one = a * b.transpose();
  TruncatedSvd svd = truncated_svd(source_of(rank_one), components(8));
  CHECK(svd.singular[0] == Approx(a.cast<double>().norm() * b.cast<double>().norm()).epsilon(1e-6));
  CHECK(svd.singular[1] < 1e-6 * svd.singular[0]);
  CHECK(error(rank_one, svd) < 1e-6 * rank_one.norm());

  const RowMatrixXf zero = RowMatrixXf::Zero(40, 70);
  for (const bool centred : {false, true}) {
    svd = truncated_svd(source_of(zero), components(8, centred));
    CHECK(svd.singular.maxCoeff() == 0);
    CHECK(rebuilt(svd).cwiseAbs().maxCoeff() == 0);
    CHECK(svd.left.allFinite());
  }

  RowMatrixXf repeated(50, 60);
  for (int j = 0; j < 60; ++j) repeated.col(j) = noise(50, 1, j % 3).col(0);
  svd = truncated_svd(source_of(repeated), components(8));
  CHECK(error(repeated, svd) < 1e-6 * repeated.norm());

  const RowMatrixXf few = noise(3, 200, 9);
  svd = truncated_svd(source_of(few), components(8));
  CHECK(svd.singular.size() == 3);
  CHECK(error(few, svd) < 1e-6 * few.norm());
  svd = truncated_svd(source_of(few.transpose()), components(8));
  CHECK(svd.singular.size() == 3);

  const RowMatrixXf one = RowMatrixXf::Constant(1, 1, 7);
  svd = truncated_svd(source_of(one), components(8));
  CHECK(svd.singular[0] == Approx(7));
}

TEST_CASE("A truncated SVD finds what lies a millionth below one specular row") {
  RowMatrixXf m = decaying(64, 100, 0.8);
  m.row(17) *= 1e6F;
  for (const std::size_t count : {1, 4, 8}) {
    const TruncatedSvd svd = truncated_svd(source_of(m), components(count));
    CHECK(error(m, svd) <= 1.01 * least_error(m.cast<double>(), count, false));
  }
  // Over the whole range of what a BTF in floats holds.
  m *= 1e2F;
  CHECK(error(m, truncated_svd(source_of(m), components(8))) <=
        1.01 * least_error(m.cast<double>(), 8, false));
}

TEST_CASE("A truncated SVD is the same with one thread and with two, and reads few rows at once") {
  const RowMatrixXf m = decaying(700, 6000, 0.9);  // more rows than one block has
  std::atomic<std::size_t> most = 0;
  RowSource source = source_of(m);
  source.read = [&, inner = source.read](std::size_t first, std::size_t count, float* values) {
    std::size_t before = most;
    while (before < count && !most.compare_exchange_weak(before, count)) {
    }
    inner(first, count, values);
  };
  std::vector<TruncatedSvd> found;
  for (const std::size_t threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    TruncatedSvdOptions options = components(3, true);
    options.iterations = 1;
    found.push_back(truncated_svd(source, options));
  }
  const bool same = found[0].left == found[1].left && found[0].right == found[1].right &&
                    found[0].singular == found[1].singular && found[0].mean == found[1].mean;
  CHECK(same);
  CHECK(most <= 64);
}
