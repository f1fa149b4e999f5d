#include "codecs/lafortune/lafortune_representation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "btf/raw_appearance.h"
#include "codecs/branchless_exp.h"

namespace weft::lafortune {

LafortuneRepresentation::LafortuneRepresentation(Model model)
    : model_(std::move(model)), texels_(model_.texels) {
  const std::size_t stride = 4 * model_.quads();
  for (std::size_t texel = 0; texel < texels_.size(); texel += stride) {
    for (std::size_t k = 0; k < model_.lobes; ++k) {
      float* c = &texels_[texel + 4 * k];
      const float peak = std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[2])});
      const float by = peak > 0 ? std::pow(peak, 1 / c[3] - 1) : 0;
      for (int i = 0; i < 3; ++i) c[i] *= by;
    }
    for (std::size_t i = 0; i < 3; ++i) texels_[texel + stride - 4 + i] *= model_.scale;
  }
}

Rgb LafortuneRepresentation::evaluate(Texcoord uv, Direction light, Direction view,
                                      float /*lod*/) const {
  if (!(light.z > 0) || !(view.z > 0)) return {0, 0, 0};
  const TexelStencil stencil = bilinear_texels(uv, model_.head.width, model_.head.height);
  const std::size_t stride = 4 * model_.quads();
  const float x = light.x * view.x;
  const float y = light.y * view.y;
  const float z = light.z * view.z;
  Rgb sum(0, 0, 0);
  for (std::size_t t = 0; t < 4; ++t) {
    const float* texel = &texels_[stencil.index[t] * stride];
    const float* last = texel + stride - 4;
    float value = last[3];
    for (std::size_t k = 0; k < model_.lobes; ++k) {
      const float* c = texel + 4 * k;
      const float product = c[0] * x + c[1] * y + c[2] * z;
      // A NaN stays one.
      value += product <= 0 ? 0 : product * branchless_power(product, c[3] - 1);
    }
    sum += Rgb(last[0], last[1], last[2]) * (value * stencil.weight[t]);
  }
  return sum * light.z;
}

}  // namespace weft::lafortune
