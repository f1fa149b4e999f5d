// The lights of a dataset, sixteen side by side.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "btf/direction.h"
#include "tracer/lanes.h"

namespace weft {

class LightSet {
 public:
  explicit LightSet(std::vector<Direction> directions);

  std::size_t size() const { return directions_.size(); }
  const Direction& operator[](std::size_t light) const { return directions_[light]; }
  std::span<const Direction> directions() const { return directions_; }

  /// Light l is lane l % 16 of group l / 16. Lanes beyond the last light point straight down.
  std::size_t groups() const { return groups_.size(); }
  const Vec3Lanes& group(std::size_t g) const { return groups_[g]; }
  /// Bit i set where lane i of the group is a light.
  std::uint16_t used_lanes(std::size_t g) const {
    const std::size_t left = size() - g * lanes;
    return left >= lanes ? 0xFFFF : static_cast<std::uint16_t>((1U << left) - 1U);
  }

 private:
  std::vector<Direction> directions_;
  std::vector<Vec3Lanes> groups_;
};

}  // namespace weft
