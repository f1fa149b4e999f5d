#include "codecs/factor_maps/parabolic_map.h"

#include <algorithm>
#include <cmath>

namespace weft::factor_maps {

BilinearTaps ParabolicMap::taps(const Direction& direction) const {
  const Vec2 p = parabolic(direction);
  const auto last = static_cast<float>(resolution_ - 1);
  const float x = std::clamp((p.x + 1) * 0.5F * last, 0.0F, last);
  const float y = std::clamp((1 - p.y) * 0.5F * last, 0.0F, last);
  // A NaN may not be cast; it stays in the weights.
  const int column = x > 0 ? std::min(static_cast<int>(x), resolution_ - 2) : 0;
  const int row = y > 0 ? std::min(static_cast<int>(y), resolution_ - 2) : 0;
  const float a = x - static_cast<float>(column);
  const float b = y - static_cast<float>(row);
  const auto first = static_cast<std::uint32_t>(row * resolution_ + column);
  const auto below = first + static_cast<std::uint32_t>(resolution_);
  return {{first, first + 1, below, below + 1},
          {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b}};
}

Direction ParabolicMap::direction(int texel) const {
  const auto last = static_cast<float>(resolution_ - 1);
  Vec2 p(2 * static_cast<float>(texel % resolution_) / last - 1,
         1 - 2 * static_cast<float>(texel / resolution_) / last);
  const float radius = p.length();
  if (radius > 1) p /= radius;
  Direction d = from_parabolic(p);
  d.z = std::max(d.z, 0.0F);
  return d;
}

}  // namespace weft::factor_maps
