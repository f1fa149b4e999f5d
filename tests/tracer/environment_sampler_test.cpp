// The environment: its orientation, and samples that are distributed as their density says.

#include "tracer/lights/environment_sampler.h"

#include <cmath>
#include <numbers>

#include "btf/error.h"
#include "btf/random.h"
#include "tests/statistics.h"

namespace weft {
namespace {

/// A picture whose pixels are all different: red counts columns, green rows.
EnvironmentLight numbered(int width, int height, float rotate = 0) {
  EnvironmentLight light;
  light.radiance = Image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) light.radiance.set_rgb(x, y, {1.0F + x, 1.0F + y, 0.5F});
  }
  light.rotate = rotate;
  return light;
}

TEST_CASE("Row 0 is the zenith, the centre looks along +x, left of it +y", "[environment]") {
  const EnvironmentLight light = numbered(8, 4);
  const EnvironmentSampler sampler(light);
  const auto column = [&](const Direction& d) { return sampler.radiance(d).x - 1; };
  CHECK(sampler.radiance({0, 0.01F, 0.99995F}).y == 1);
  CHECK(sampler.radiance({0, 0.01F, -0.99995F}).y == 4);
  CHECK(column(from_spherical(1.6, 0.01)) == 3);  // phi = 0 lies between columns 3 and 4
  CHECK(column(from_spherical(1.6, -0.01)) == 4);
  CHECK(column(from_spherical(1.6, std::numbers::pi / 2 + 0.01)) == 1);
  CHECK(column(from_spherical(1.6, std::numbers::pi / 2 - 0.01)) == 2);
  CHECK(column(from_spherical(1.6, std::numbers::pi - 0.01)) == 0);
  CHECK(column(from_spherical(1.6, std::numbers::pi + 0.01)) == 7);
}

TEST_CASE("rotate turns the environment about +z", "[environment]") {
  const EnvironmentLight straight = numbered(16, 8), turned = numbered(16, 8, radians(90.0F));
  const EnvironmentSampler a(straight), b(turned);
  for (double phi = 0.05; phi < 6.2; phi += 0.3) {
    CHECK(a.radiance(from_spherical(1, phi)) ==
          b.radiance(from_spherical(1, phi + std::numbers::pi / 2)));
  }
}

TEST_CASE("Samples carry the radiance and density of their direction", "[environment]") {
  const EnvironmentLight light = numbered(16, 8, 0.4F);
  const EnvironmentSampler sampler(light);
  int apart = 0;  // a sample on the edge between two pixels may be rounded into its neighbour
  for (int i = 0; i < 2000; ++i) {
    const auto s =
        sampler.sample(unit_float(hash_coordinates(i, 1)), unit_float(hash_coordinates(i, 2)));
    CHECK(s.direction.length() == Approx(1).epsilon(1e-6));
    apart +=
        sampler.radiance(s.direction) == s.radiance && sampler.pdf(s.direction) == s.pdf ? 0 : 1;
  }
  CHECK(apart <= 2);
}

TEST_CASE("The density integrates to one and the samples follow it", "[environment]") {
  EnvironmentLight light = numbered(16, 8);
  for (int x = 0; x < 16; ++x)
    light.radiance.set_rgb(x, 2, {0, 0, 0});         // black pixels are never chosen
  light.radiance.set_rgb(5, 6, {4000, 4000, 4000});  // a sun
  const EnvironmentSampler sampler(light);
  // Counted in cells of a grid three times as fine as the picture, of equal solid angle within a
  // row of pixels.
  constexpr int columns = 48, rows = 8, count = 200000;
  std::vector<double> observed(columns * rows, 0), expected(columns * rows, 0);
  for (int i = 0; i < count; ++i) {
    const Direction d =
        sampler.sample(unit_float(hash_coordinates(i, 3)), unit_float(hash_coordinates(i, 4)))
            .direction;
    const int row = std::min(rows - 1, static_cast<int>(theta_of(d) / std::numbers::pi * rows));
    const int column =
        std::min(columns - 1, static_cast<int>(phi_of(d) / (2 * std::numbers::pi) * columns));
    ++observed[row * columns + column];
  }
  double integral = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double top = std::cos(std::numbers::pi * row / rows),
                   bottom = std::cos(std::numbers::pi * (row + 1) / rows);
      const double share =
          sampler.pdf(from_spherical(std::acos((top + bottom) / 2),
                                     2 * std::numbers::pi * (column + 0.5) / columns)) *
          (top - bottom) * 2 * std::numbers::pi / columns;
      expected[row * columns + column] = share * count;
      integral += share;
    }
  }
  CHECK(integral == Approx(1).epsilon(1e-5));
  CHECK(statistics::chi2_test(observed, expected) > 1e-3);
  // Not by chance: against an even distribution over the sphere's columns it fails.
  std::reverse(expected.begin(), expected.end());
  CHECK(statistics::chi2_test(observed, expected) < 1e-6);
}

TEST_CASE("A black environment has no samples, a negative one of a program's is refused",
          "[environment]") {
  EnvironmentLight light;
  light.radiance = Image(4, 2);
  CHECK(EnvironmentSampler(light).sample(0.3F, 0.4F).pdf == 0);
  CHECK(EnvironmentSampler(light).pdf({0, 0, 1}) == 0);
  light.radiance.set_rgb(3, 1, {1, -2, 3});
  CHECK_THROWS_WITH(EnvironmentSampler(light), Catch::Contains("x = 3, y = 1"));
}

}  // namespace
}  // namespace weft
