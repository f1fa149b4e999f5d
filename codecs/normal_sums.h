// Normal equations of a small fit, summed over eight samples at a time.
#pragma once

#include <array>

#include "codecs/branchless_double.h"
#include "codecs/levenberg_marquardt.h"

namespace weft {

template <int N>
class NormalSums {
 public:
  /// @param row       of the Jacobian, of eight samples.
  /// @param residual  data - model.
  void add(const std::array<DoubleLanes, N>& row, const DoubleLanes& residual) {
    error_ += residual * residual;
    for (int a = 0; a < N; ++a) {
      right_[a] += row[a] * residual;
      for (int b = 0; b <= a; ++b) matrix_[a][b] += row[a] * row[b];
    }
  }

  NormalEquations<N> sums() const {
    NormalEquations<N> normal;
    normal.error = sum_of(error_);
    for (int a = 0; a < N; ++a) {
      normal.right[a] = sum_of(right_[a]);
      for (int b = 0; b <= a; ++b) normal.matrix[a][b] = sum_of(matrix_[a][b]);
    }
    return normal;
  }

 private:
  std::array<std::array<DoubleLanes, N>, N> matrix_{};
  std::array<DoubleLanes, N> right_{};
  DoubleLanes error_{};
};

}  // namespace weft
