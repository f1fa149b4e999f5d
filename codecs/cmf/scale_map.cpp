#include "codecs/cmf/scale_map.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cstddef>

#include "codecs/cmf/decode.h"

namespace weft::cmf {

namespace {

// Taps of all pairs, [view][light] as the data lies: shared by all texels.
std::vector<FactorTaps> pair_taps(const Model& model) {
  std::vector<FactorTaps> taps;
  taps.reserve(model.views.size() * model.lights.size());
  for (const Direction& view : model.views.directions()) {
    for (const Direction& light : model.lights.directions())
      taps.push_back(factor_taps(model, light, view));
  }
  return taps;
}

}  // namespace

std::vector<float> least_squares_scale(const Btf& btf, const Model& model) {
  const std::vector<FactorTaps> taps = pair_taps(model);
  std::vector<float> scale(3 * static_cast<std::size_t>(model.width) * model.height);
  tbb::parallel_for(0, model.width * model.height, [&](int texel) {
    std::vector<float> values(3 * taps.size());
    btf.abrdf(texel % model.width, texel / model.width, values);
    std::array<double, 3> product{};
    std::array<double, 3> square{};
    for (std::size_t pair = 0; pair < taps.size(); ++pair) {
      const Rgb g = factor_product(model, static_cast<std::size_t>(texel), taps[pair]) *
                    model.lights[pair % model.lights.size()].z;
      for (int c = 0; c < 3; ++c) {
        product[c] += static_cast<double>(g[c]) * values[3 * pair + c];
        square[c] += static_cast<double>(g[c]) * g[c];
      }
    }
    for (int c = 0; c < 3; ++c) {
      scale[3 * static_cast<std::size_t>(texel) + c] =
          square[c] > 0 ? static_cast<float>(product[c] / square[c]) : 0.0F;
    }
  });
  return scale;
}

}  // namespace weft::cmf
