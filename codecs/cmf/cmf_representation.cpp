#include "codecs/cmf/cmf_representation.h"

#include "btf/raw_appearance.h"
#include "codecs/cmf/atlas.h"
#include "codecs/cmf/decode.h"

namespace weft::cmf {

Rgb CmfRepresentation::evaluate(Texcoord uv, Direction light, Direction view, float /*lod*/) const {
  if (!(light.z > 0) || !(view.z > 0)) return {0, 0, 0};
  const TexelStencil texels = bilinear_texels(uv, model_.width, model_.height);
  const FactorTaps taps = factor_taps(model_, light, view);
  Rgb sum(0, 0, 0);
  for (std::size_t t = 0; t < 4; ++t) {
    if (texels.weight[t] == 0) continue;
    const std::size_t texel = texels.index[t];
    sum += factor_product(model_, texel, taps) * model_.scale_of(texel) * texels.weight[t];
  }
  return sum * light.z;
}

std::size_t CmfRepresentation::bytes() const {
  std::size_t bytes = model_.index.size() + model_.scale.texture_bytes();
  for (std::size_t f = 0; f < model_.factors.size(); ++f) {
    const std::size_t bytes_a_value = model_.factors[f].maps.floats.empty() ? 1 : sizeof(float);
    bytes += 3 * atlas_layout(model_, f).texels() * bytes_a_value;
  }
  return bytes;
}

}  // namespace weft::cmf
