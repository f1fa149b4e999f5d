// An orthonormal frame around a normal.
#pragma once

#include <cmath>
#include <numbers>

#include "btf/direction.h"

namespace weft {

struct Frame {
  Vec3 x, y, z;
  Vec3 to_local(const Vec3& v) const { return {v ^ x, v ^ y, v ^ z}; }
  Vec3 to_world(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
};

/// Duff et al., "Building an orthonormal basis, revisited", JCGT 6(1), 2017.
inline Frame frame_around(const Vec3& n) {
  const float sign = std::copysign(1.0F, n.z);
  const float a = -1.0F / (sign + n.z);
  const float b = n.x * n.y * a;
  return {{1.0F + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

/// A direction with density cos(theta) / pi from two numbers in [0, 1).
inline Direction cosine_direction(float u, float v) {
  const float r = std::sqrt(u);
  const float phi = 2 * std::numbers::pi_v<float> * v;
  return {r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - u)};
}

}  // namespace weft
