#include "codecs/factor_maps/atlas.h"

namespace weft::factor_maps {

AtlasLayout atlas_layout(const Model& model, std::size_t factor) {
  const int maps = static_cast<int>(model.map_count(factor));
  const int columns = model.clustered ? std::min(maps, 16) : model.width();
  return {columns, (maps + columns - 1) / columns, model.resolution, model.factors[factor].terms};
}

int texel_rows(const Model& model) {
  const auto width = static_cast<std::size_t>(model.width());
  return static_cast<int>((model.texels() + width - 1) / width);
}

}  // namespace weft::factor_maps
