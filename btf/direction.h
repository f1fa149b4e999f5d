// Directions in the local frame of a surface: +z the macro normal, +x the tangent dP/du, +y the
// bitangent.
//
// `light` points from the surface to the light, `view` to the viewer. `theta` is measured from +z,
// `phi` from +x towards +y. Radians in code, degrees in files and on the command line.
#pragma once

#include <cmath>
#include <numbers>

#include "btf/vector.h"

namespace weft {

/// A unit vector.
using Direction = Vec3;

constexpr float radians(float degrees) {
  return degrees * (std::numbers::pi_v<float> / 180.0F);
}
constexpr double radians(double degrees) {
  return degrees * (std::numbers::pi / 180.0);
}
constexpr float degrees(float radians) {
  return radians * (180.0F / std::numbers::pi_v<float>);
}
constexpr double degrees(double radians) {
  return radians * (180.0 / std::numbers::pi);
}

/// Unit vector of the angles (radians). Computed in double so that grazing cosines keep their
/// digits.
inline Direction from_spherical(double theta, double phi) {
  return {static_cast<float>(std::sin(theta) * std::cos(phi)),
          static_cast<float>(std::sin(theta) * std::sin(phi)), static_cast<float>(std::cos(theta))};
}

/// Angle from +z in [0, pi]; accurate near the pole too.
inline float theta_of(const Direction& d) {
  return std::atan2(std::hypot(d.x, d.y), d.z);
}

/// Angle from +x towards +y in [0, 2 pi); 0 at the pole.
inline float phi_of(const Direction& d) {
  const float phi = std::atan2(d.y, d.x);
  return phi < 0 ? phi + 2 * std::numbers::pi_v<float> : phi;
}

/// Parabolic image (x, y) / (1 + z): the upper hemisphere onto the unit disc. Needs z > -1.
inline Vec2 parabolic(const Direction& d) {
  return Vec2(d.x, d.y) / (1.0F + d.z);
}

/// Inverse of `parabolic`.
inline Direction from_parabolic(const Vec2& p) {
  const float r2 = p.x * p.x + p.y * p.y;
  return Vec3(2 * p.x, 2 * p.y, 1 - r2) / (1 + r2);
}

}  // namespace weft
