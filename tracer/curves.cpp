#include "tracer/curves.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace weft {

namespace {

// A place on a segment's axis, and how it goes on per unit of u.
struct Axis {
  Vec3 centre;
  Vec3 step;
  float radius;
  float widening;
};

Axis axis_at(const CurveSet::Control* c, float u) {
  const float w = 1 - u;
  const std::array<float, 4> at{w * w * w / 6, (4 + u * u * (3 * u - 6)) / 6,
                                (4 + w * w * (3 * w - 6)) / 6, u * u * u / 6};
  const std::array<float, 4> slope{-w * w / 2, u * (3 * u - 4) / 2, w * (4 - 3 * w) / 2, u * u / 2};
  Axis axis{Vec3(0), Vec3(0), 0, 0};
  for (std::size_t k = 0; k < 4; ++k) {
    axis.centre += c[k].position * at[k];
    axis.step += c[k].position * slope[k];
    axis.radius += c[k].radius * at[k];
    axis.widening += c[k].radius * slope[k];
  }
  return axis;
}

// The angle counts from `x`, where an axis of space that a segment hardly follows points: one for
// the whole segment, so that rounding cannot turn the frame round.
struct Across {
  Vec3 x, y;
};

Across across(const CurveSet::Control* c, const Vec3& along) {
  const Vec3 chord = c[2].position - c[1].position;
  int least = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::abs(chord[k]) < std::abs(chord[least])) least = k;
  }
  Vec3 x(0);
  x[least] = 1;
  x = (x - along * along[least]).normalized();
  return {x, along % x};
}

// The least value of a uniform cubic B-spline with these controls, for u from 0 to 1.
double least_of(const std::array<double, 4>& c) {
  const auto at = [&](double u) {
    const double w = 1 - u;
    return (w * w * w * c[0] + (4 + u * u * (3 * u - 6)) * c[1] + (4 + w * w * (3 * w - 6)) * c[2] +
            u * u * u * c[3]) /
           6;
  };
  double least = std::min(at(0), at(1));
  // Where the slope a u^2 + b u + d is zero.
  const double a = (-c[0] + 3 * c[1] - 3 * c[2] + c[3]) / 2;
  const double b = c[0] - 2 * c[1] + c[2];
  const double d = (c[2] - c[0]) / 2;
  const double root = std::sqrt(std::max(0.0, b * b - 4 * a * d));
  const double q = -0.5 * (b + std::copysign(root, b));
  for (const double u : {q / a, d / q}) {  // not a number, or outside, where there is none
    if (u > 0 && u < 1) least = std::min(least, at(u));
  }
  return least;
}

}  // namespace

void CurveSet::add_strand(std::span<const Control> strand, std::uint16_t material) {
  const auto first = static_cast<std::uint32_t>(controls.size());
  controls.insert(controls.end(), strand.begin(), strand.end());
  for (std::uint32_t k = 0; k + 3 < strand.size(); ++k) {
    segments.push_back(first + k);
    materials.push_back(material);
  }
}

CurvePoint curve_point(const CurveSet::Control* segment, float u, float v) {
  const Axis axis = axis_at(segment, u);
  const Vec3 along = axis.step.normalized();
  const auto [x, y] = across(segment, along);
  const float angle = 2 * std::numbers::pi_v<float> * v;
  const Vec3 outwards = x * std::cos(angle) + y * std::sin(angle);
  // A tube that widens leans its normals back.
  const Vec3 normal = outwards * axis.step.length() - along * axis.widening;
  const float length = normal.length();
  return {axis.centre + outwards * axis.radius, length > 0 ? normal / length : outwards};
}

float curve_angle(const CurveSet::Control* segment, float u, const Vec3& normal) {
  const auto [x, y] = across(segment, axis_at(segment, u).step.normalized());
  const float turn = std::atan2(normal ^ y, normal ^ x) / (2 * std::numbers::pi_v<float>);
  return turn < 0 ? turn + 1 : turn;
}

Bounds bounds_of(const CurveSet& curves) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Imath::V3d low(infinity);
  Imath::V3d high(-infinity);
  for (const std::uint32_t first : curves.segments) {
    const CurveSet::Control* c = &curves.controls[first];
    for (int axis = 0; axis < 3; ++axis) {
      std::array<double, 4> below{};
      std::array<double, 4> above{};  // turned upside down
      for (std::size_t k = 0; k < 4; ++k) {
        below[k] = static_cast<double>(c[k].position[axis]) - c[k].radius;
        above[k] = -static_cast<double>(c[k].position[axis]) - c[k].radius;
      }
      low[axis] = std::min(low[axis], least_of(below));
      high[axis] = std::max(high[axis], -least_of(above));
    }
  }
  return {Vec3(low), Vec3(high)};
}

}  // namespace weft
