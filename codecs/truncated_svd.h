// The best few components of a matrix that is read a few rows at a time: randomised subspace
// iteration (Halko, Martinsson and Tropp, SIAM Review 2011, algorithms 4.4 and 5.1), in double.
//
// What it holds is (rows + columns) x (components + oversampling) doubles and one block of rows, so
// the matrix itself may be larger than memory. Both halves of each iteration are orthogonalised: a
// component 1e6 times weaker than the first is found as well as the first.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

namespace weft {

/// A matrix by its rows. `read` fills `count` rows from `first` on, one after another, `columns`
/// floats each; it is called from several threads at once, several times for each row.
struct RowSource {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::function<void(std::size_t first, std::size_t count, float* values)> read;
};

struct TruncatedSvdOptions {
  std::size_t components = 8;
  bool centred = false;  ///< takes the mean row away first: a PCA
  std::size_t oversampling = 10;
  int iterations = 2;
  std::uint64_t seed = 0;
};

/// A = left diag(singular) right^T (+ mean, in each row). The number of components is at most the
/// smaller side of the matrix; those beyond its rank have singular value 0, or rounding's.
struct TruncatedSvd {
  Eigen::MatrixXd left;      ///< rows x components, orthonormal columns
  Eigen::VectorXd singular;  ///< descending, >= 0
  Eigen::MatrixXd right;     ///< columns x components, orthonormal columns; each one's largest
                             ///< entry is positive, so that signs do not depend on chance
  Eigen::VectorXd mean;      ///< columns; zero unless centred
};

/// The error in the Frobenius norm is within 1 % of the least one (Eckart and Young; tested). The
/// same for any number of threads. Needs finite values.
TruncatedSvd truncated_svd(const RowSource& source, const TruncatedSvdOptions& options);

}  // namespace weft
