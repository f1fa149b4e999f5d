#include "codecs/cmf/model.h"

#include <algorithm>
#include <cmath>

namespace weft::cmf {

std::string name_of(Projection projection) {
  switch (projection) {
    case Projection::light:
      return "light";
    case Projection::half:
      return "half";
    case Projection::view:
      return "view";
  }
  return "";
}

std::vector<std::uint8_t> to_bytes(const std::vector<float>& values) {
  std::vector<std::uint8_t> bytes(values.size());
  std::ranges::transform(values, bytes.begin(), [](float v) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0F, 1.0F) * 255.0F));
  });
  return bytes;
}

}  // namespace weft::cmf
