// Facets cut into small triangles, for each of which something is kept.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "acquisition/facets.h"

namespace weft {

/// u, v of a point of a facet (or of a cell): what belongs to its second and third corner.
using Barycentric = std::array<float, 2>;

/// A small triangle of a facet.
struct Cell {
  std::uint32_t facet;
  std::array<Barycentric, 3> corners;
};

/// Hands out the corners of the side * side cells that a triangle is cut into, in the order of
/// `enter`: `take(p, q, r)`, each {i, j} for the place with weights i / side and j / side of the
/// triangle's second and third corner.
template <typename Take>
void for_each_cell(int side, const Take& take) {
  using Place = std::array<int, 2>;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; i + j < side; ++j) {
      take(Place{i, j}, Place{i + 1, j}, Place{i, j + 1});
      if (i + j + 1 < side) take(Place{i + 1, j + 1}, Place{i, j + 1}, Place{i + 1, j});
    }
  }
}

/// Appends the side * side cells that `whole` is cut into, in the order of `enter`.
void cut(const Cell& whole, int side, std::vector<Cell>& cells);

/// The number of the cell that `at` lies in, of a triangle that is cut into side * side; `at`
/// becomes the place in that cell. A point off the triangle by a rounding lies in the nearest cell.
inline std::uint32_t enter(int side, Barycentric& at) {
  const auto scale = static_cast<float>(side);
  const float u = at[0] * scale;
  const float v = at[1] * scale;
  const int row = std::clamp(static_cast<int>(u), 0, side - 1);
  const int column = static_cast<int>(v);
  const bool turned = u - static_cast<float>(row) + v - static_cast<float>(column) > 1;
  // Along a row, cells that point the way of the whole alternate with those turned round.
  const int position = std::clamp(2 * column + (turned ? 1 : 0), 0, 2 * (side - row) - 2);
  const int pair = position / 2;
  at = {u - static_cast<float>(row), v - static_cast<float>(pair)};
  if (position % 2 == 1) at = {1 - at[0], 1 - at[1]};
  return static_cast<std::uint32_t>(row * (2 * side - row) + position);
}

/// A random point of a cell; of four rounds in a row each lies in another quarter.
Barycentric random_point(const Cell& cell, std::size_t number, int round);

/// The point of the cell with weights 1 - a - b, a and b of its corners.
Barycentric point_of(const Cell& cell, float a, float b);

/// The cells of all facets, numbered in the order of the facets, then of `enter`. A facet is cut so
/// that no edge of a cell is longer than 1/96 of a tile, but into 128 a side at most.
class FacetCells {
 public:
  /// Of no facet.
  FacetCells() = default;
  explicit FacetCells(const std::vector<Facet>& facets);

  std::size_t facets() const { return wholes_.size(); }
  std::size_t count() const { return count_; }
  std::vector<Cell> all() const;
  /// The number of the cell of a facet that `at` lies in; `at` becomes the place in that cell.
  std::uint32_t find(std::uint32_t facet, Barycentric& at) const {
    const Whole& whole = wholes_[facet];
    return whole.first + (whole.side == 1 ? 0 : enter(whole.side, at));
  }

 private:
  struct Whole {
    std::uint32_t first;
    std::int32_t side;  // side * side cells in all
  };
  std::vector<Whole> wholes_;
  std::uint32_t count_ = 0;
};

}  // namespace weft
