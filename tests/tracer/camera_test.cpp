// The camera: which way is up, right and ahead, how wide it sees, and how its rays change over a
// pixel.

#include "tracer/camera.h"

#include "btf/direction.h"
#include "btf/error.h"

namespace weft {
namespace {

const Camera looking_north{{1, 2, 3}, {1, 10, 3}, {0, 0, 1}, 60, 300, 200};

TEST_CASE("Row 0 is the top, column 0 the left", "[camera]") {
  const PerspectiveCamera camera(looking_north);
  const CameraRay centre = camera.ray(150, 100);
  CHECK((centre.direction - Vec3(0, 1, 0)).length() < 1e-6F);
  CHECK(centre.origin == Vec3(1, 2, 3));
  CHECK(camera.ray(150, 0.5).direction.z > 0);
  CHECK(camera.ray(0.5, 100).direction.x < 0);
}

TEST_CASE("fov is the vertical full angle", "[camera]") {
  const PerspectiveCamera camera(looking_north);
  const Vec3 top = camera.ray(150, 0).direction, bottom = camera.ray(150, 200).direction;
  CHECK(degrees(std::acos(top.dot(bottom))) == Approx(60).epsilon(1e-5));
  // Pixels are square.
  const Vec3 left = camera.ray(0, 100).direction;
  CHECK(-left.x / left.y == Approx(1.5 * std::tan(radians(30.0))).epsilon(1e-5));
}

TEST_CASE("Differentials are those of the rays", "[camera]") {
  const PerspectiveCamera camera(looking_north);
  const CameraRay ray = camera.ray(30, 20);
  const Vec3 dx = (camera.ray(30.5, 20).direction - camera.ray(29.5, 20).direction);
  const Vec3 dy = (camera.ray(30, 20.5).direction - camera.ray(30, 19.5).direction);
  CHECK((dx - ray.direction_dx).length() < 1e-3F * dx.length());
  CHECK((dy - ray.direction_dy).length() < 1e-3F * dy.length());
}

TEST_CASE("A camera that cannot be is refused", "[camera]") {
  Camera camera = looking_north;
  camera.target = camera.eye;
  CHECK_THROWS_AS(PerspectiveCamera(camera), Error);
  camera = looking_north;
  camera.up = {0, 2, 0};
  CHECK_THROWS_AS(PerspectiveCamera(camera), Error);
  camera = looking_north;
  camera.fov = 180;
  CHECK_THROWS_AS(PerspectiveCamera(camera), Error);
}

}  // namespace
}  // namespace weft
