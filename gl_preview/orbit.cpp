// Spherical coordinates about an axis.

#include "gl_preview/orbit.h"

#include <algorithm>
#include <cmath>

namespace weft {

namespace {

Vec3 any_perpendicular(const Vec3& v) {
  return (std::abs(v.x) < 0.5F ? Vec3(1, 0, 0) : Vec3(0, 1, 0)).cross(v).normalized();
}

}  // namespace

Vec3 turned(const Vec3& offset, const Vec3& up, float azimuth, float elevation) {
  const float length = offset.length();
  const float height = offset.dot(up);
  const Vec3 flat = offset - height * up;
  const Vec3 ahead = flat.length() > 1e-6F * length ? flat.normalized() : any_perpendicular(up);
  const float highest = radians(89.0F);
  const float e = std::clamp(std::atan2(height, flat.length()) + elevation, -highest, highest);
  const Vec3 around = std::cos(azimuth) * ahead + std::sin(azimuth) * up.cross(ahead);
  return length * (std::cos(e) * around + std::sin(e) * up);
}

Camera orbited(Camera camera, float azimuth, float elevation) {
  camera.eye = camera.target +
               turned(camera.eye - camera.target, camera.up.normalized(), azimuth, elevation);
  return camera;
}

Camera dollied(Camera camera, float factor) {
  camera.eye = camera.target + factor * (camera.eye - camera.target);
  return camera;
}

PreviewLights with_first_light_turned(PreviewLights lights, const Vec3& centre, const Vec3& up,
                                      float azimuth, float elevation) {
  const Vec3 axis = up.normalized();
  if (!lights.points.empty()) {
    Vec3& position = lights.points.front().position;
    position = centre + turned(position - centre, axis, azimuth, elevation);
  } else if (!lights.directionals.empty()) {
    Direction& direction = lights.directionals.front().direction;
    direction = turned(direction, axis, azimuth, elevation).normalized();
  }
  return lights;
}

}  // namespace weft
