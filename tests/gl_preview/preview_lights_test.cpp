// Environments as directional lights.

#include "gl_preview/preview_lights.h"

#include <catch2/catch.hpp>
#include <numbers>

using namespace weft;

namespace {

EnvironmentLight constant_environment(int width, int height, const Rgb& radiance) {
  EnvironmentLight environment{Image(width, height), 0};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) environment.radiance.set_rgb(x, y, radiance);
  }
  return environment;
}

}  // namespace

TEST_CASE("Median cut spreads power evenly and lights a floor as the sky would") {
  const auto lights = median_cut(constant_environment(256, 128, {1, 0.5F, 0.25F}), 32);
  REQUIRE(lights.size() == 32);
  Rgb sum(0, 0, 0);
  Vec3 balance(0);
  float floor_irradiance = 0;
  for (const DirectionalLight& light : lights) {
    CHECK(light.direction.length() == Approx(1));
    CHECK(light.irradiance.x == Approx(4 * std::numbers::pi / 32).epsilon(0.2));
    sum += light.irradiance;
    balance += light.direction * light.irradiance.x;
    floor_irradiance += light.irradiance.x * std::max(light.direction.z, 0.0F);
  }
  // Regions are not points: a light carries their vector irradiance, a little less than their
  // power.
  CHECK(sum.x == Approx(4 * std::numbers::pi).epsilon(0.06));
  CHECK(sum.z == Approx(sum.x / 4));
  CHECK(balance.length() < 0.2F);
  // A floor under a sky of radiance 1 gets pi.
  CHECK(floor_irradiance == Approx(std::numbers::pi).epsilon(0.01));
}

TEST_CASE("A lone bright pixel lights from its own direction") {
  EnvironmentLight environment{Image(16, 8), 0};
  // Column 8 of 16 is just right of the centre, which looks along +x; row 3 is just above the
  // horizon.
  environment.radiance.set_rgb(8, 3, {10, 10, 10});
  const auto lights = median_cut(environment, 32);
  REQUIRE(lights.size() == 1);
  CHECK(degrees(theta_of(lights[0].direction)) == Approx(78.75).epsilon(1e-3));
  CHECK(degrees(std::atan2(lights[0].direction.y, lights[0].direction.x)) ==
        Approx(-11.25).epsilon(1e-3));
  environment.rotate = radians(90.0F);
  const Direction rotated = median_cut(environment, 32)[0].direction;
  CHECK(degrees(std::atan2(rotated.y, rotated.x)) == Approx(78.75).epsilon(1e-3));
}

TEST_CASE("A black environment gives no light") {
  CHECK(median_cut(constant_environment(8, 4, {0, 0, 0}), 32).empty());
}
