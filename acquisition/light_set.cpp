#include "acquisition/light_set.h"

#include <utility>

namespace weft {

LightSet::LightSet(std::vector<Direction> directions)
    : directions_(std::move(directions)), groups_((directions_.size() + lanes - 1) / lanes) {
  for (std::size_t l = 0; l < groups_.size() * lanes; ++l) {
    const Direction d = l < size() ? directions_[l] : Direction(0, 0, -1);
    Vec3Lanes& group = groups_[l / lanes];
    group.x[l % lanes] = d.x;
    group.y[l % lanes] = d.y;
    group.z[l % lanes] = d.z;
  }
}

}  // namespace weft
