// The points of one texel's samples in a pair of dimensions, drawn sixteen at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "tracer/lanes.h"

namespace weft {

class SamplePoints {
 public:
  static constexpr std::uint32_t most = 64;        ///< at once
  static_assert(most % lanes == 0 && most < 256);  // counted in bytes

  /// Draws points `first` to `first + count` (at most `most`) of the sequence that `key` names: the
  /// same ones as `sobol_point` gives.
  void draw(std::uint64_t key, std::uint32_t first, std::uint32_t count);

  /// @param i  counted from `first`.
  std::array<float, 2> operator[](std::uint32_t i) const {
    return {x_[i / lanes][i % lanes], y_[i / lanes][i % lanes]};
  }

  /// Numbers of the points (counted from `first`) along a Morton curve over 8 x 8 squares: sixteen
  /// in a row are near each other, so that the rays through them meet the same few facets.
  std::span<const std::uint8_t> along_curve();

 private:
  std::uint32_t count_ = 0;
  std::array<FloatLanes, most / lanes> x_{};
  std::array<FloatLanes, most / lanes> y_{};
  std::array<std::uint8_t, most> order_{};
};

}  // namespace weft
