// The nearest of a sampling's directions, looked up in a table over the parabolic square.
//
// Cells at the border between two directions answer for one of them throughout, so the answer is
// the nearest but for half a cell, the same on CPU and GPU. Paper 000, section 3.4, step 1.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "codecs/gl_program.h"
#include "codecs/stencil_batch.h"

namespace weft {

class NearestTable {
 public:
  explicit NearestTable(const HemisphereSampling& sampling);

  /// @param direction  unit, z >= 0. A sampled one answers itself.
  std::uint16_t operator()(const Direction& direction) const {
    const float scale = 1 / (1 + direction.z);
    return table_[static_cast<std::size_t>(place(direction.y * scale)) * size_ +
                  place(direction.x * scale)];
  }

  /// Of sixteen.
  Batch<std::int32_t> operator()(const DirectionLanes& directions) const {
    alignas(64) Batch<std::int32_t> cell;
    for (std::size_t i = 0; i < batch_lanes; ++i) {
      const float scale = 1 / (1 + directions.z[i]);
      cell[i] = place(directions.y[i] * scale) * size_ + place(directions.x[i] * scale);
    }
    Batch<std::int32_t> nearest;
    for (std::size_t i = 0; i < batch_lanes; ++i) nearest[i] = table_[cell[i]];
    return nearest;
  }

  /// `int PREFIX_nearest(vec3 direction)`, with its table, a texture buffer.
  GlProgram glsl(const std::string& prefix) const;

  std::size_t bytes() const { return table_.size() * sizeof(std::uint16_t); }

 private:
  int place(float p) const {  // a NaN is 0
    const float q = (p + 1) * (static_cast<float>(size_) / 2);
    return q > 0 ? (q < static_cast<float>(size_ - 1) ? static_cast<int>(q) : size_ - 1) : 0;
  }

  int size_;
  std::vector<std::uint16_t> table_;  // [y][x]
};

}  // namespace weft
