#include "codecs/cmf/anisotropy.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

#include "codecs/factor_maps/half_difference.h"

namespace weft::cmf {

namespace {

// First and second moments of the half-vectors' (x, y).
struct Moments {
  double x = 0, y = 0, xx = 0, yy = 0, xy = 0;
};

double azimuth_of(const Moments& m) {
  const double angle = 0.5 * std::atan2(2 * m.xy, m.xx - m.yy);
  const bool other_end = m.x * std::cos(angle) + m.y * std::sin(angle) < 0;
  return other_end ? angle + std::numbers::pi : angle;
}

std::uint8_t steps_of(double azimuth) {
  constexpr int steps = factor_maps::rotation_steps;
  const auto nearest = std::lround(azimuth / (2 * std::numbers::pi) * steps);
  return static_cast<std::uint8_t>((nearest % steps + steps) % steps);
}

}  // namespace

std::vector<std::uint8_t> greatest_anisotropy(const factor_maps::TexelSource& source) {
  const auto& lights = source.finest().lights();
  const auto& views = source.finest().views();
  std::vector<Vec2> halves;
  for (const Direction& view : views.directions()) {
    for (const Direction& light : lights.directions()) {
      const Direction half = factor_maps::half_vector(light, view);
      halves.emplace_back(half.x, half.y);
    }
  }
  std::vector<std::uint8_t> steps(source.size());
  tbb::parallel_for(std::size_t{0}, source.size(), [&](std::size_t texel) {
    std::vector<float> values(3 * halves.size());
    source.abrdf(texel, values);
    Moments m;
    for (std::size_t pair = 0; pair < halves.size(); ++pair) {
      const double w = values[3 * pair] + values[3 * pair + 1] + values[3 * pair + 2];
      const Vec2& h = halves[pair];
      m.x += w * h.x;
      m.y += w * h.y;
      m.xx += w * h.x * h.x;
      m.yy += w * h.y * h.y;
      m.xy += w * h.x * h.y;
    }
    const double azimuth = azimuth_of(m);
    steps[texel] = std::isfinite(azimuth) ? steps_of(azimuth) : 0;
  });
  return steps;
}

}  // namespace weft::cmf
