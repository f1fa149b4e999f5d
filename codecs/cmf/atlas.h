// How the maps of a factor lie in one 2D texture, on the GPU and in its file: side by side, row
// after row.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "codecs/cmf/model.h"

namespace weft::cmf {

/// `columns` maps across and `rows` down; map i at column i % columns, row i / columns.
struct AtlasLayout {
  int columns;
  int rows;
  int resolution;

  int width() const { return columns * resolution; }
  int height() const { return rows * resolution; }
  std::size_t texels() const { return static_cast<std::size_t>(width()) * height(); }
  /// First value, in the atlas, of row `map_row` of all maps' rows one after another.
  std::size_t row_start(std::size_t map_row) const {
    const std::size_t map = map_row / resolution;
    const std::size_t y = map / columns * resolution + map_row % resolution;
    return 3 * (y * width() + map % columns * resolution);
  }
};

/// 16 across for a codebook; as the tile's own texels lie for unclustered maps.
AtlasLayout atlas_layout(const Model& model, std::size_t factor);

/// The atlas's texels [y][x][rgb] from [map][row][column][rgb]; places without a map are zero.
/// Empty for empty maps.
template <typename Value>
std::vector<Value> to_atlas(const std::vector<Value>& maps, const AtlasLayout& layout) {
  std::vector<Value> atlas(maps.empty() ? 0 : 3 * layout.texels());
  const std::size_t row_values = 3 * static_cast<std::size_t>(layout.resolution);
  for (std::size_t i = 0; i < maps.size(); i += row_values) {
    std::copy_n(&maps[i], row_values, &atlas[layout.row_start(i / row_values)]);
  }
  return atlas;
}

/// The inverse, for `count` maps.
template <typename Value>
std::vector<Value> from_atlas(const std::vector<Value>& atlas, const AtlasLayout& layout,
                              std::size_t count) {
  std::vector<Value> maps(3 * count * layout.resolution * layout.resolution);
  const std::size_t row_values = 3 * static_cast<std::size_t>(layout.resolution);
  for (std::size_t i = 0; i < maps.size(); i += row_values) {
    std::copy_n(&atlas[layout.row_start(i / row_values)], row_values, &maps[i]);
  }
  return maps;
}

}  // namespace weft::cmf
