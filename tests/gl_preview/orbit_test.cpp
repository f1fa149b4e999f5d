// Where the mouse takes camera and light.

#include "gl_preview/orbit.h"

#include <catch2/catch.hpp>

using namespace weft;

TEST_CASE("A quarter turn about z goes from +x to +y and keeps height and distance") {
  const Vec3 found = turned({3, 0, 4}, {0, 0, 1}, radians(90.0F), 0);
  CHECK(found.equalWithAbsError({0, 3, 4}, 1e-5F));
}

TEST_CASE("Raising stops at 89 degrees, and works from the pole itself") {
  const Vec3 up(0, 0, 1);
  for (const Vec3& from : {Vec3(2, 0, 0), Vec3(0, 0, 2), Vec3(0, 0, -2)}) {
    const Vec3 high = turned(from, up, 0.3F, 10);
    CHECK(high.length() == Approx(2));
    CHECK(degrees(theta_of(high.normalized())) == Approx(1).epsilon(1e-3));
    CHECK(degrees(theta_of(turned(from, up, 0.3F, -10).normalized())) == Approx(179).epsilon(1e-3));
  }
}

TEST_CASE(
    "The camera turns about its target, the first light about the target or in its direction") {
  Camera camera;
  camera.target = {1, 1, 0};
  camera.eye = {3, 1, 0};
  CHECK(orbited(camera, radians(90.0F), 0).eye.equalWithAbsError({1, 3, 0}, 1e-5F));
  CHECK(dollied(camera, 0.5F).eye.equalWithAbsError({2, 1, 0}, 1e-6F));
  PreviewLights lights;
  lights.directionals = {{{1, 0, 0}, {1, 1, 1}}};
  CHECK(with_first_light_turned(lights, camera.target, {0, 0, 1}, radians(90.0F), 0)
            .directionals[0]
            .direction.equalWithAbsError({0, 1, 0}, 1e-5F));
  lights.points = {{{2, 1, 5}, {1, 1, 1}}};
  const PreviewLights moved =
      with_first_light_turned(lights, camera.target, {0, 0, 1}, radians(90.0F), 0);
  CHECK(moved.points[0].position.equalWithAbsError({1, 2, 5}, 1e-5F));
  CHECK(moved.directionals[0].direction == Vec3(1, 0, 0));
}
