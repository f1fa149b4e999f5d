// One viewer, many lights: a `Bsdf` evaluated over a structure of arrays.
#pragma once

#include <cstddef>
#include <vector>

#include "tracer/bsdf.h"

namespace weft {

/// Light directions in a surface's frame.
struct LightBatch {
  std::vector<float> x, y, z;
  explicit LightBatch(std::size_t n) : x(n), y(n), z(n) {}
  std::size_t size() const { return x.size(); }
};

/// One colour a light.
struct RgbBatch {
  std::vector<float> r, g, b;
  explicit RgbBatch(std::size_t n) : r(n), g(n), b(n) {}
};

/// `values` become what `bsdf.evaluate` says for each light (to rounding). Sizes are equal.
void evaluate_lights(const Bsdf& bsdf, const LightBatch& lights, const Direction& view,
                     RgbBatch& values);

}  // namespace weft
