#include "codecs/factor_maps/factor_map_representation.h"

#include "codecs/factor_maps/atlas.h"
#include "codecs/factor_maps/model_file.h"

namespace weft::factor_maps {

Rgb FactorMapRepresentation::evaluate(Texcoord uv, Direction light, Direction view,
                                      float lod) const {
  return decoder_.evaluate(uv, light, view, lod);
}

void FactorMapRepresentation::evaluate(std::span<const AppearanceQuery> queries,
                                       std::span<Rgb> answers) const {
  decoder_.evaluate(queries, answers);
}

std::size_t FactorMapRepresentation::bytes() const {
  const std::size_t texels = static_cast<std::size_t>(model_.width()) * texel_rows(model_);
  const bool eight_bit = model_.scale.floats.empty();
  const std::size_t bytes_a_value = eight_bit ? 1 : sizeof(float);
  std::size_t bytes = texels * 3 * bytes_a_value;
  if (model_.clustered) bytes += texels * model_.index_channels();
  if (!model_.rotation.empty()) bytes += texels;
  for (std::size_t f = 0; f < model_.factors.size(); ++f) {
    bytes += 3 * atlas_layout(model_, f).texels() * bytes_a_value;
  }
  return bytes;
}

void FactorMapRepresentation::save(const std::filesystem::path& folder) const {
  write_model(folder, model_);
}

}  // namespace weft::factor_maps
