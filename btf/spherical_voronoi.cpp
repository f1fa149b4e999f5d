// Solid angles of a hemisphere sampling: each direction's Voronoi cell, cut out of the hemisphere
// by great circles.
#include <cmath>

#include "btf/hemisphere_sampling.h"

namespace weft {

namespace {

using Point = Imath::V3d;

// What is left of a spherical polygon on the side of `normal`.
std::vector<Point> clip(const std::vector<Point>& polygon, const Point& normal) {
  std::vector<Point> inside;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& a = polygon[i];
    const Point& b = polygon[(i + 1) % polygon.size()];
    const double da = a ^ normal;
    const double db = b ^ normal;
    if (da >= 0) inside.push_back(a);
    if ((da >= 0) != (db >= 0))
      inside.push_back((a * db - b * da).normalized() * (db > da ? 1 : -1));
  }
  return inside;
}

// Van Oosterom and Strackee 1983, eq. 8.
double triangle_area(const Point& a, const Point& b, const Point& c) {
  return 2 * std::atan2(a ^ (b % c), 1 + (a ^ b) + (b ^ c) + (c ^ a));
}

// Convex and less than a quarter of the hemisphere.
double polygon_area(const std::vector<Point>& polygon) {
  double area = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    area += triangle_area(polygon[0], polygon[i], polygon[i + 1]);
  }
  return area;
}

// The hemisphere in four triangles: no polygon then has antipodal corners, whose great circle is
// not one.
std::array<std::vector<Point>, 4> quadrants() {
  std::array<std::vector<Point>, 4> result;
  const std::array<Point, 4> horizon{Point(1, 0, 0), Point(0, 1, 0), Point(-1, 0, 0),
                                     Point(0, -1, 0)};
  for (std::size_t k = 0; k < 4; ++k)
    result[k] = {Point(0, 0, 1), horizon[k], horizon[(k + 1) % 4]};
  return result;
}

}  // namespace

std::vector<double> HemisphereSampling::solid_angles() const {
  std::vector<double> areas;
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    double area = 0;
    for (std::vector<Point> part : quadrants()) {
      for (std::size_t j = 0; j < directions_.size() && !part.empty(); ++j) {
        if (j != i) part = clip(part, Point(directions_[i]) - Point(directions_[j]));
      }
      area += polygon_area(part);
    }
    areas.push_back(area);
  }
  return areas;
}

}  // namespace weft
