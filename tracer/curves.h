// Round fibres: tubes along uniform cubic B-splines.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "btf/vector.h"

namespace weft {

/// Segment s is swept by a circle along the B-spline of the controls segments[s] to segments[s] +
/// 3; segments that share three controls join without a seam. Ends are open: taper them.
struct CurveSet {
  struct Control {
    Vec3 position;
    float radius = 0;
  };
  std::vector<Control> controls;
  std::vector<std::uint32_t> segments;   ///< the first of a segment's controls
  std::vector<std::uint16_t> materials;  ///< one a segment

  /// n >= 4 controls make n - 3 segments.
  void add_strand(std::span<const Control> strand, std::uint16_t material);
};

/// A point of a tube and the unit normal there, outwards.
struct CurvePoint {
  Vec3 position;
  Vec3 normal;
};

/// @param segment  its four controls.
/// @param u        from 0 to 1 along the segment.
/// @param v        from 0 to 1 around it.
CurvePoint curve_point(const CurveSet::Control* segment, float u, float v);
inline CurvePoint curve_point(const CurveSet& curves, std::size_t segment, float u, float v) {
  return curve_point(&curves.controls[curves.segments[segment]], u, v);
}

/// Where around a tube its normal (of any length) has the direction of `normal`.
float curve_angle(const CurveSet::Control* segment, float u, const Vec3& normal);

/// A box around all tubes, tight where their radius is constant; turned inside out where there are
/// none.
struct Bounds {
  Vec3 low, high;
};
Bounds bounds_of(const CurveSet& curves);

}  // namespace weft
