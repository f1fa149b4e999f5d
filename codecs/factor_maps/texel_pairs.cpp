#include "codecs/factor_maps/texel_pairs.h"

namespace weft::factor_maps {

std::vector<TexelPair> texel_pairs(std::span<const std::uint8_t> maps, int resolution) {
  const auto columns = static_cast<std::size_t>(resolution);
  const std::size_t rows = maps.size() / (3 * columns);
  std::vector<TexelPair> pairs;
  pairs.reserve(maps.size() / (3 * columns * columns) * pairs_a_map(resolution));
  for (std::size_t row = 0; row < rows; ++row) {
    if (row % columns == columns - 1) continue;
    for (std::size_t column = 0; column < columns; ++column) {
      const std::span upper = maps.subspan(3 * (row * columns + column));
      const std::span lower = upper.subspan(3 * columns);
      pairs.push_back({{upper[0], upper[1], upper[2], 0}, {lower[0], lower[1], lower[2], 0}});
    }
  }
  return pairs;
}

}  // namespace weft::factor_maps
