#include "codecs/cmf/atlas.h"

namespace weft::cmf {

AtlasLayout atlas_layout(const Model& model, std::size_t factor) {
  if (!model.clustered) return {model.width, model.height, model.resolution};
  const int maps = static_cast<int>(model.map_count(factor));
  const int columns = std::min(maps, 16);
  return {columns, (maps + columns - 1) / columns, model.resolution};
}

}  // namespace weft::cmf
