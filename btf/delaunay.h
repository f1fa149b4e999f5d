// Delaunay triangulation of a few thousand points in the plane.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "btf/vector.h"

namespace weft {

/// Triangles of the Delaunay triangulation, counter-clockwise. Points on one empty circle (within
/// 2e-6) form a polygon that is cut into a fan from its lowest index, so that rings of directions
/// have one answer. Empty for fewer than three points and for collinear ones. O(n^2).
std::vector<std::array<std::uint16_t, 3>> delaunay_triangles(std::span<const Vec2> points);

}  // namespace weft
