// Facets cut into small triangles, for which a visibility table keeps its answers.
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

/// Into how many cells a side a facet is cut, so that no edge is longer than 1/96 of a tile; side *
/// side in all.
int cells_a_side(const Facet& facet);

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
  at = {u - static_cast<float>(row), v - static_cast<float>(position / 2)};
  if (position % 2 == 1) at = {1 - at[0], 1 - at[1]};
  return static_cast<std::uint32_t>(row * (2 * side - row) + position);
}

/// A random point of a cell; of four rounds in a row each lies in another quarter.
Barycentric random_point(const Cell& cell, std::size_t number, int round);

/// The point of the cell with weights 1 - a - b, a and b of its corners.
Barycentric point_of(const Cell& cell, float a, float b);

/// One number for what is the same place of the endless surface, to 1e-6 tiles.
std::uint64_t place_key(const Vec3& point);

}  // namespace weft
