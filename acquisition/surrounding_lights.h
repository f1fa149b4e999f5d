// Which lights stand around a direction: a place that sees them all most likely sees what lies
// between them, too.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "acquisition/light_set.h"

namespace weft {

class SurroundingLights {
 public:
  /// Lights of one group of sixteen, a bit each.
  struct Part {
    std::uint32_t group;
    std::uint16_t lights;
  };

  /// Of no lights.
  SurroundingLights() = default;
  explicit SurroundingLights(const LightSet& lights);

  /// The eight lights nearest to a unit vector, where all are within 40 degrees and they stand on
  /// all sides of it; otherwise none, as below the lowest lights or where lights are few.
  std::span<const Part> around(const Direction& direction) const {
    if (parts_.empty() || !(direction.z > 0)) return {};
    const std::size_t bin = bin_of(direction);
    return std::span(parts_).subspan(first_[bin], first_[bin + 1] - first_[bin]);
  }

 private:
  static constexpr int side = 64;  // bins a side of the hemisphere's octahedral map
  static std::size_t bin_of(const Direction& direction);
  // The next bin, which these lights surround.
  void add_bin(std::span<const std::uint32_t> lights);

  std::vector<Part> parts_;
  std::vector<std::uint32_t> first_;  // part of each bin, and the end
};

}  // namespace weft
