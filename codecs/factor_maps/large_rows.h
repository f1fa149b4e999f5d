// Rows of a matrix that grow with a dataset, in memory or in a scratch file.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "btf/large_array.h"

namespace weft::factor_maps {

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
/// Any such matrix, wherever it lies.
using Rows = Eigen::Ref<const RowMatrix>;

class LargeRows {
 public:
  LargeRows() = default;
  /// All zero.
  LargeRows(Eigen::Index rows, Eigen::Index columns, std::shared_ptr<MemoryBudget> memory)
      : rows_(rows),
        columns_(columns),
        values_(static_cast<std::size_t>(rows * columns), std::move(memory)) {}
  /// A copy in memory.
  LargeRows(const RowMatrix& matrix) : LargeRows(matrix.rows(), matrix.cols(), nullptr) {
    this->matrix() = matrix;
  }

  Eigen::Map<RowMatrix> matrix() { return {values_.data(), rows_, columns_}; }
  Eigen::Map<const RowMatrix> matrix() const { return {values_.data(), rows_, columns_}; }
  std::span<const float> values() const { return values_.values(); }
  const std::shared_ptr<MemoryBudget>& memory() const { return values_.budget(); }

 private:
  Eigen::Index rows_ = 0;
  Eigen::Index columns_ = 0;
  LargeArray<float> values_;
};

}  // namespace weft::factor_maps
