// How the maps of a factor lie in one 2D texture, on the GPU and in its file: side by side, row
// after row. The terms of a map lie below each other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "codecs/factor_maps/model.h"

namespace weft::factor_maps {

/// `columns` maps across and `rows` down; map i at column i % columns, row i / columns.
struct AtlasLayout {
  int columns;
  int rows;
  int resolution;
  int terms;

  int map_height() const { return terms * resolution; }
  int width() const { return columns * resolution; }
  int height() const { return rows * map_height(); }
  std::size_t texels() const { return static_cast<std::size_t>(width()) * height(); }
  /// First value, in the atlas, of row `map_row` of all maps' rows one after another.
  std::size_t row_start(std::size_t map_row) const {
    const std::size_t map = map_row / map_height();
    const std::size_t y = map / columns * map_height() + map_row % map_height();
    return 3 * (y * width() + map % columns * resolution);
  }
};

/// 16 across for a codebook; as wide as the tile for unclustered maps.
AtlasLayout atlas_layout(const Model& model, std::size_t factor);

/// Rows of the textures of one value a texel of any level (index, scale): as wide as the tile, the
/// levels one after another, filled up to whole rows.
int texel_rows(const Model& model);

/// The atlas's texels [y][x][rgb] from [map][term][row][column][rgb]; places without a map are
/// zero. Empty for empty maps.
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
  const std::size_t row_values = 3 * static_cast<std::size_t>(layout.resolution);
  std::vector<Value> maps(count * layout.map_height() * row_values);
  for (std::size_t i = 0; i < maps.size(); i += row_values) {
    std::copy_n(&atlas[layout.row_start(i / row_values)], row_values, &maps[i]);
  }
  return maps;
}

}  // namespace weft::factor_maps
