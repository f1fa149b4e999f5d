#include "codecs/truncated_svd.h"

#include <tbb/parallel_for.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "btf/random.h"

namespace weft {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowBlock = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Sizes are fixed, so that sums have the same order for any number of threads.
constexpr Index rows_a_task = 32;
constexpr Index columns_a_task = 512;
constexpr Index doubles_a_block = Index{1} << 22;  // 32 MiB

class Reader {
 public:
  explicit Reader(const RowSource& source)
      : source_(source),
        mean_(VectorXd::Zero(columns())),
        block_rows_(std::clamp((doubles_a_block / std::max<Index>(columns(), 1)) / rows_a_task,  //
                               Index{1}, Index{64}) *
                    rows_a_task) {}

  Index rows() const { return static_cast<Index>(source_.rows); }
  Index columns() const { return static_cast<Index>(source_.columns); }
  const VectorXd& mean() const { return mean_; }

  void take_mean() {
    VectorXd sum = VectorXd::Zero(columns());
    each_block(
        [&](Index, const RowBlock& block) { add_transposed(block, ones(block.rows()), sum); });
    mean_ = sum / std::max<double>(1.0, static_cast<double>(rows()));
  }

  // A right
  MatrixXd times(const MatrixXd& right) const {
    MatrixXd product(rows(), right.cols());
    tbb::parallel_for(Index{0}, (rows() + rows_a_task - 1) / rows_a_task, [&](Index task) {
      const Index first = task * rows_a_task;
      const RowBlock block = read(first, std::min(rows_a_task, rows() - first));
      product.middleRows(first, block.rows()).noalias() = block * right;
    });
    return product;
  }

  // A^T left
  MatrixXd transposed_times(const MatrixXd& left) const {
    MatrixXd product = MatrixXd::Zero(columns(), left.cols());
    each_block([&](Index first, const RowBlock& block) {
      add_transposed(block, left.middleRows(first, block.rows()), product);
    });
    return product;
  }

 private:
  static MatrixXd ones(Index n) { return MatrixXd::Ones(n, 1); }

  RowBlock read(Index first, Index count) const {
    RowBlock block(count, columns());
    std::vector<float> values(static_cast<std::size_t>(count) * source_.columns);
    source_.read(static_cast<std::size_t>(first), static_cast<std::size_t>(count), values.data());
    const auto floats =
        Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
            values.data(), count, columns());
    block = floats.cast<double>();
    block.rowwise() -= mean_.transpose();
    return block;
  }

  template <typename Use>
  void each_block(const Use& use) const {
    for (Index first = 0; first < rows(); first += block_rows_) {
      RowBlock block(std::min(block_rows_, rows() - first), columns());
      tbb::parallel_for(Index{0}, (block.rows() + rows_a_task - 1) / rows_a_task, [&](Index task) {
        const Index row = task * rows_a_task;
        const Index count = std::min(rows_a_task, block.rows() - row);
        block.middleRows(row, count) = read(first + row, count);
      });
      use(first, block);
    }
  }

  // sum += block^T left, a task a few columns: each sum's order is that of the rows.
  template <typename Left, typename Sum>
  static void add_transposed(const RowBlock& block, const Left& left, Sum& sum) {
    const Index tasks = (block.cols() + columns_a_task - 1) / columns_a_task;
    tbb::parallel_for(Index{0}, tasks, [&](Index task) {
      const Index first = task * columns_a_task;
      const Index count = std::min(columns_a_task, block.cols() - first);
      sum.middleRows(first, count).noalias() += block.middleCols(first, count).transpose() * left;
    });
  }

  const RowSource& source_;
  VectorXd mean_;
  Index block_rows_;
};

// Householder's, whose columns are orthonormal where `m` lacks rank too.
MatrixXd orthonormal(const MatrixXd& m) {
  if (m.cols() == 0) return m;
  const Eigen::HouseholderQR<MatrixXd> qr(m);
  return qr.householderQ() * MatrixXd::Identity(m.rows(), m.cols());
}

MatrixXd gaussian(Index rows, Index columns, std::uint64_t seed) {
  MatrixXd m(rows, columns);
  tbb::parallel_for(Index{0}, columns, [&](Index j) {
    for (Index i = 0; i < rows; ++i) {
      const double u = 1 - static_cast<double>(unit_float(hash_coordinates(seed, i, j, 0)));
      const double v = unit_float(hash_coordinates(seed, i, j, 1));
      m(i, j) = std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
    }
  });
  return m;
}

void fix_signs(TruncatedSvd& svd) {
  for (Index k = 0; k < svd.right.cols(); ++k) {
    Index largest = 0;
    svd.right.col(k).cwiseAbs().maxCoeff(&largest);
    if (svd.right(largest, k) < 0) {
      svd.right.col(k) = -svd.right.col(k);
      svd.left.col(k) = -svd.left.col(k);
    }
  }
}

}  // namespace

TruncatedSvd truncated_svd(const RowSource& source, const TruncatedSvdOptions& options) {
  Reader reader(source);
  if (options.centred) reader.take_mean();
  const Index least = std::min(reader.rows(), reader.columns());
  const Index kept = std::min(least, static_cast<Index>(options.components));
  const Index sketched = std::min(least, kept + static_cast<Index>(options.oversampling));

  MatrixXd left = orthonormal(reader.times(gaussian(reader.columns(), sketched, options.seed)));
  for (int i = 0; i < options.iterations; ++i) {
    const MatrixXd right = orthonormal(reader.transposed_times(left));
    left = orthonormal(reader.times(right));
  }
  // A ~ left left^T A. The small side of left^T A = (Q R)^T is decomposed as R = U S V^T.
  const MatrixXd projected = reader.transposed_times(left);
  const MatrixXd q = orthonormal(projected);
  const MatrixXd r = q.transpose() * projected;
  const Eigen::JacobiSVD<MatrixXd> small(r, Eigen::ComputeThinU | Eigen::ComputeThinV);

  TruncatedSvd result;
  result.left = left * small.matrixV().leftCols(kept);
  result.singular = small.singularValues().head(kept);
  result.right = q * small.matrixU().leftCols(kept);
  result.mean = reader.mean();
  fix_signs(result);
  return result;
}

}  // namespace weft
