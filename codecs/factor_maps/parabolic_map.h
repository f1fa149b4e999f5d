// Where a direction lies in a factor's square texture: parabolic maps whose corner texels are
// centred on (+-1, +-1).
//
// So every direction down to the horizon has four valid neighbours, and no filter reads past the
// border.
#pragma once

#include <array>
#include <cstdint>

#include "btf/direction.h"

namespace weft::factor_maps {

/// Four texels (row * resolution + column) and their bilinear weights, which sum to 1.
struct BilinearTaps {
  std::array<std::uint32_t, 4> index;
  std::array<float, 4> weight;
};

class ParabolicMap {
 public:
  /// @param resolution  texels a side, at least 2.
  explicit ParabolicMap(int resolution) : resolution_(resolution) {}

  int resolution() const { return resolution_; }
  int texels() const { return resolution_ * resolution_; }

  /// Of a direction with z >= 0. Row 0 is +y, as in pictures.
  BilinearTaps taps(const Direction& direction) const;

  /// The direction at a texel's centre; beyond the unit disc, the one at the horizon nearest to it.
  Direction direction(int texel) const;

 private:
  int resolution_;
};

}  // namespace weft::factor_maps
