// A bed on which bodies come to rest one after another, over the periodic tile.
#pragma once

#include <vector>

#include "tracer/triangle_mesh.h"

namespace weft {

/// Heights of what lies there already, cell by cell of a grid over the tile. A body that is let
/// down at a place stops where its underside meets them; nothing slides or rolls.
class StoneBed {
 public:
  /// An empty bed at height 0. @param size  cells along each side.
  explicit StoneBed(int size)
      : size_(size), heights_(static_cast<std::size_t>(size) * size, 0.0F) {}

  /// A closed body that is no wider than the tile, as seen from above and below, cell by cell.
  struct Footprint {
    struct Cell {
      int x, y;  // from the body's own origin
      float lower, upper;
    };
    std::vector<Cell> cells;
  };
  Footprint footprint(const TriangleMesh& body) const;

  int size() const { return size_; }
  /// How far the body must be raised to rest with its origin in the middle of cell (x, y).
  float rest(const Footprint& body, int x, int y) const;
  void lay(const Footprint& body, int x, int y, float height);

 private:
  std::size_t index(int x, int y) const;

  int size_;
  std::vector<float> heights_;
};

}  // namespace weft
