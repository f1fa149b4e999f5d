// Random questions to an appearance, the same in every run.
#pragma once

#include <vector>

#include "btf/appearance.h"
#include "btf/random.h"

/// A direction of the upper hemisphere, evenly over its solid angle.
inline weft::Direction random_direction(std::uint64_t seed, std::uint64_t index) {
  const double z = weft::unit_float(weft::hash_coordinates(seed, index, 0));
  const double phi =
      2 * std::numbers::pi * weft::unit_float(weft::hash_coordinates(seed, index, 1));
  return weft::from_spherical(std::acos(z), phi);
}

/// uv in [-2, 3)^2 (they repeat), light and view over the hemisphere.
inline weft::AppearanceQuery random_query(std::uint64_t index, float lod) {
  const auto coordinate = [&](std::uint64_t axis) {
    return 5 * weft::unit_float(weft::hash_coordinates(7, index, axis)) - 2;
  };
  return {{coordinate(0), coordinate(1)},
          random_direction(11, index),
          random_direction(13, index),
          lod};
}
