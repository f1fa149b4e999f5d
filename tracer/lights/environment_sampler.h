// Draws directions towards an environment in proportion to its radiance.
//
// The environment is constant over each of its pixels, in lookup and in sampling alike, so that the
// density is exact: a pixel is chosen in proportion to its mean radiance times its solid angle (the
// sine of theta integrated over its row), and a direction evenly over that solid angle.
#pragma once

#include <vector>

#include "btf/direction.h"
#include "tracer/scene.h"

namespace weft {

class EnvironmentSampler {
 public:
  /// Keeps a reference to `light`. @throws Error where a pixel is negative or not finite, naming
  /// it.
  explicit EnvironmentSampler(const EnvironmentLight& light);

  struct Sample {
    Direction direction;
    Rgb radiance;
    float pdf = 0;  ///< per sr; 0 where the environment is black everywhere
  };
  /// `u0`, `u1` in [0, 1).
  Sample sample(float u0, float u1) const;

  Rgb radiance(const Direction& direction) const;
  /// Density of `sample` at `direction`, per sr.
  float pdf(const Direction& direction) const;

 private:
  struct PixelIndex {
    int x, y;
  };
  PixelIndex pixel_of(const Direction& direction) const;
  double solid_angle(int row) const;
  float pixel_pdf(PixelIndex pixel) const;

  const EnvironmentLight& light_;
  std::vector<double> row_edges_;    ///< cumulative weight at the rows' edges, height + 1
  std::vector<double> pixel_edges_;  ///< the same within each row, (width + 1) a row
};

}  // namespace weft
