// Random cells over the periodic tile: the Voronoi cells of one point in each square of a grid.
//
// After S. Worley, "A Cellular Texture Basis Function", SIGGRAPH 96; with distances to the borders
// of the cell instead of those to the points, so that borders are equally wide everywhere.
#pragma once

#include <array>
#include <cstdint>

#include "btf/vector.h"

namespace weft {

/// Where a place lies in its cell.
struct CellPlace {
  std::array<double, 24> border;  ///< distances to the borders with others nearby, in squares
  std::uint64_t hash;             ///< of the cell

  /// Rises from 0 on the cell's border to 1 inside over about `width` (in squares): a product of 1
  /// - exp(-(d / width)^2) over the borders. Smooth (with its slope) across borders and corners.
  double rise(double width) const;
};

class PeriodicCells {
 public:
  /// @param squares  of the grid along x and y; at least 4 each, so that no point is its own
  ///                 neighbour.
  /// @param jitter   0: points in the squares' middles, 1: anywhere in them.
  PeriodicCells(Imath::V2i squares, double jitter, std::uint64_t seed)
      : squares_(squares), jitter_(jitter), seed_(seed) {}

  /// @param p  in tiles.
  CellPlace at(const Imath::V2d& p) const;

 private:
  Imath::V2i squares_;
  double jitter_;
  std::uint64_t seed_;
};

}  // namespace weft
