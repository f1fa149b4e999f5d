// Which lights stand around a direction.
#include "acquisition/surrounding_lights.h"

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>

#include "btf/hemisphere_sampling.h"
#include "btf/random.h"

using namespace weft;

namespace {

int count_of(std::span<const SurroundingLights::Part> parts) {
  int count = 0;
  for (const auto& part : parts) count += std::popcount(part.lights);
  return count;
}

Direction random_direction(int i) {
  const float z = unit_float(hash_coordinates(i, 0));
  const double phi = 6.2831853 * unit_float(hash_coordinates(i, 1));
  const float r = std::sqrt(1 - z * z);
  return {r * static_cast<float>(std::cos(phi)), r * static_cast<float>(std::sin(phi)), z};
}

}  // namespace

TEST_CASE("the lights around a direction are near it and on all sides") {
  for (const char* name : {"ubo81", "ubo151", "fibonacci:400"}) {
    const LightSet lights(named_directions(name));
    const SurroundingLights surrounding(lights);
    int surrounded = 0;
    constexpr int directions = 20'000;
    for (int i = 0; i < directions; ++i) {
      const Direction direction = random_direction(i);
      const auto around = surrounding.around(direction);
      if (around.empty()) continue;
      ++surrounded;
      CHECK(count_of(around) == 8);
      Vec3 sum(0, 0, 0);
      for (const auto& [group, bits] : around) {
        for (int lane = 0; lane < lanes; ++lane) {
          if ((bits >> lane & 1) == 0) continue;
          const Direction& light = lights[static_cast<std::size_t>(group) * lanes + lane];
          CHECK((light ^ direction) > std::cos(radians(35.0)));
          sum += light - direction * (light ^ direction);
        }
      }
      CHECK(sum.length() / 8 < std::sin(radians(20.0)));  // none far off to one side
    }
    INFO(name << ": " << surrounded);
    CHECK(surrounded > 0.6 * directions);
  }
}

TEST_CASE("nothing surrounds a direction below the lowest lights, or where lights are few") {
  const LightSet ubo(named_directions("ubo81"));
  const SurroundingLights around_ubo(ubo);
  for (int i = 0; i < 360; ++i) {
    CHECK(around_ubo.around(from_spherical(radians(80.0), radians(1.0 * i))).empty());
    CHECK_FALSE(around_ubo.around(from_spherical(radians(50.0), radians(1.0 * i))).empty());
  }
  CHECK(around_ubo.around({0, 0, -1}).empty());
  CHECK(around_ubo.around({1, 0, 0}).empty());
  for (const char* name :
       {"fibonacci:1", "fibonacci:3", "fibonacci:7", "regular:2x3", "fibonacci:10"}) {
    const LightSet few(named_directions(name));
    const SurroundingLights around_few(few);
    for (int i = 0; i < 1000; ++i) CHECK(around_few.around(random_direction(i)).empty());
  }
}
