// A homogeneous material asked as an `Appearance`: the same everywhere, whatever the uv.
#pragma once

#include "btf/appearance.h"
#include "tracer/bsdf.h"

namespace weft {

class BsdfAppearance : public Appearance {
 public:
  explicit BsdfAppearance(Bsdf bsdf) : bsdf_(std::move(bsdf)) {}

  using Appearance::evaluate;
  Rgb evaluate(Texcoord uv, Direction light, Direction view, float lod) const override;
  bool has_lod() const override { return false; }
  Imath::V2i texels() const override { return {1, 1}; }

 private:
  Bsdf bsdf_;
};

}  // namespace weft
