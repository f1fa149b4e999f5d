#include "codecs/factor_maps/model.h"

#include <algorithm>
#include <cmath>

#include "btf/error.h"

namespace weft::factor_maps {

std::string name_of(Projection projection) {
  switch (projection) {
    case Projection::light:
      return "light";
    case Projection::half:
      return "half";
    case Projection::difference:
      return "difference";
    case Projection::view:
      return "view";
  }
  return "";
}

Projection projection_named(const std::string& name) {
  for (const Projection p :
       {Projection::light, Projection::half, Projection::difference, Projection::view}) {
    if (name_of(p) == name) return p;
  }
  throw bad_input("factors", "there is no factor '" + name + "'",
                  "there are light, half, difference and view");
}

std::vector<std::uint8_t> to_bytes(std::span<const float> values) {
  std::vector<std::uint8_t> bytes(values.size());
  std::ranges::transform(values, bytes.begin(), [](float v) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0F, 1.0F) * 255.0F));
  });
  return bytes;
}

std::vector<Level> mip_levels(int width, int height) {
  std::vector<Level> levels{{width, height, 0}};
  while (width > 1 || height > 1) {
    const std::size_t first = levels.back().first + static_cast<std::size_t>(width) * height;
    width = std::max(1, width / 2);
    height = std::max(1, height / 2);
    levels.push_back({width, height, first});
  }
  return levels;
}

}  // namespace weft::factor_maps
