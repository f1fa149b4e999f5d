#include "codecs/factor_maps/rotation.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "codecs/factor_maps/model.h"

namespace weft::factor_maps {

HemisphereSampling turned_back(const HemisphereSampling& sampling, int steps) {
  if (steps == 0) return sampling;
  const double angle = -2 * std::numbers::pi * steps / rotation_steps;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  std::vector<Direction> directions;
  for (const Direction& d : sampling.directions()) {
    directions.emplace_back(static_cast<float>(c * d.x - s * d.y),
                            static_cast<float>(s * d.x + c * d.y), d.z);
  }
  const auto triangles = sampling.triangles();
  if (triangles.empty()) return HemisphereSampling(std::move(directions), sampling.horizon());
  return HemisphereSampling(std::move(directions), {triangles.begin(), triangles.end()},
                            sampling.horizon());
}

}  // namespace weft::factor_maps
