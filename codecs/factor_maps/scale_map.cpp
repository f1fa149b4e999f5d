#include "codecs/factor_maps/scale_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "codecs/factor_maps/decode.h"

namespace weft::factor_maps {

namespace {

// Where all pairs lie in the maps, [view][light] as the data lies: shared by all texels of one
// rotation.
std::vector<MapPlaces> pair_places(const Model& model, const Decoder& decoder, int rotation) {
  std::vector<MapPlaces> places;
  places.reserve(model.views.size() * model.lights.size());
  for (const Direction& view : model.views.directions()) {
    for (const Direction& light : model.lights.directions())
      places.push_back(decoder.places(light, view, rotation));
  }
  return places;
}

struct Sums {
  std::array<double, 3> product{};
  std::array<double, 3> square{};
};

// A few texels at a time, so that the places are read once for them all.
void solve_block(const TexelSource& source, const Model& model, const Decoder& decoder,
                 const std::vector<MapPlaces>& places, std::span<const std::size_t> texels,
                 std::vector<float>& scale) {
  std::vector<float> values(3 * places.size() * texels.size());
  for (std::size_t t = 0; t < texels.size(); ++t) {
    source.abrdf(texels[t], std::span(values).subspan(3 * places.size() * t, 3 * places.size()));
  }
  std::array<Sums, texels_a_block> sums{};
  for (std::size_t pair = 0; pair < places.size(); ++pair) {
    const float cosine = model.lights[pair % model.lights.size()].z;
    for (std::size_t t = 0; t < texels.size(); ++t) {
      const Rgb g = decoder.value(texels[t], places[pair]) * cosine;
      const float* wanted = &values[3 * (places.size() * t + pair)];
      for (int c = 0; c < 3; ++c) {
        sums[t].product[c] += static_cast<double>(g[c]) * wanted[c];
        sums[t].square[c] += static_cast<double>(g[c]) * g[c];
      }
    }
  }
  for (std::size_t t = 0; t < texels.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const double square = sums[t].square[c];
      scale[3 * texels[t] + c] =
          square > 0 ? static_cast<float>(std::max(0.0, sums[t].product[c] / square)) : 0.0F;
    }
  }
}

}  // namespace

std::vector<float> least_squares_scale(const TexelSource& source, const Model& model) {
  const Decoder decoder(model);
  std::vector<float> scale(3 * source.size());
  for (int rotation = 0; rotation < rotation_steps; ++rotation) {
    std::vector<std::size_t> texels;
    for (std::size_t t = 0; t < source.size(); ++t) {
      if ((model.rotation.empty() ? 0 : model.rotation[t]) == rotation) texels.push_back(t);
    }
    if (texels.empty()) continue;
    const std::vector<MapPlaces> places = pair_places(model, decoder, rotation);
    const std::size_t blocks = (texels.size() + texels_a_block - 1) / texels_a_block;
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
      const std::size_t first = block * texels_a_block;
      const std::size_t count = std::min<std::size_t>(texels_a_block, texels.size() - first);
      solve_block(source, model, decoder, places, std::span(texels).subspan(first, count), scale);
    });
  }
  return scale;
}

}  // namespace weft::factor_maps
