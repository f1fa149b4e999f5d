// Gift wrapping: from a directed edge, find the empty circle on its left, take the whole polygon on
// that circle, and go on from the polygon's other edges.
#include "btf/delaunay.h"

#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <set>
#include <utility>

namespace weft {

namespace {

using Point = Imath::V2d;
using Edge = std::pair<std::uint16_t, std::uint16_t>;
using Triangles = std::vector<std::array<std::uint16_t, 3>>;

double cross(const Point& a, const Point& b) {
  return a.x * b.y - a.y * b.x;
}

// Points this close to a line count as on it.
constexpr double line_tolerance = 1e-7;

class Wrapping {
 public:
  Wrapping(std::vector<Point> points, double circle_tolerance)
      : points_(std::move(points)), circle_tolerance_(circle_tolerance) {}

  /// Empty where the wrapping contradicts itself: near-ties that fall on both sides of the
  /// tolerance.
  std::optional<Triangles> run() {
    const Edge first = shortest_edge_of_first_point();
    queue_ = {first, {first.second, first.first}};
    while (!queue_.empty()) {
      const Edge edge = queue_.front();
      queue_.pop_front();
      if (done_.contains(edge)) continue;
      const std::vector<std::uint16_t> polygon = polygon_left_of(edge);
      if (polygon.empty()) continue;  // an edge of the hull
      if (!add(polygon)) return std::nullopt;
    }
    return triangles_;
  }

 private:
  // The circle with a point and its nearest neighbour as diameter holds no other point, so this is
  // an edge.
  Edge shortest_edge_of_first_point() const {
    std::uint16_t nearest = 1;
    for (std::uint16_t i = 2; i < points_.size(); ++i) {
      if ((points_[i] - points_[0]).length2() < (points_[nearest] - points_[0]).length2()) {
        nearest = i;
      }
    }
    return {0, nearest};
  }

  // Counter-clockwise, the points on the empty circle through the edge on its left; empty on the
  // hull.
  std::vector<std::uint16_t> polygon_left_of(const Edge& edge) const {
    const Point a = points_[edge.first];
    const Point b = points_[edge.second];
    const Point along = b - a;
    const double length = along.length();
    double least = std::numeric_limits<double>::infinity();
    std::size_t apex = points_.size();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double area = cross(along, points_[i] - a);
      if (area <= line_tolerance * length) continue;
      // Position of the circle's centre along the left normal, in units of the edge's length.
      const double position = ((points_[i] - a) ^ (points_[i] - b)) / (2 * area);
      if (position < least) {
        least = position;
        apex = i;
      }
    }
    if (apex == points_.size()) return {};
    const Point centre = (a + b) * 0.5 + Point(-along.y, along.x) * least;
    const double radius = (a - centre).length();
    std::vector<std::pair<double, std::uint16_t>> around;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Point from_centre = points_[i] - centre;
      const bool corner = i == edge.first || i == edge.second || i == apex;
      if (corner || (std::abs(from_centre.length() - radius) < circle_tolerance_ &&
                     cross(along, points_[i] - a) > line_tolerance * length)) {
        around.emplace_back(std::atan2(from_centre.y, from_centre.x),
                            static_cast<std::uint16_t>(i));
      }
    }
    std::sort(around.begin(), around.end());
    std::vector<std::uint16_t> polygon;
    for (const auto& [angle, index] : around) polygon.push_back(index);
    return polygon;
  }

  bool add(std::vector<std::uint16_t> polygon) {
    std::rotate(polygon.begin(), std::min_element(polygon.begin(), polygon.end()), polygon.end());
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Edge side{polygon[i], polygon[(i + 1) % polygon.size()]};
      if (!done_.insert(side).second) return false;
      queue_.emplace_back(side.second, side.first);
    }
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      triangles_.push_back({polygon[0], polygon[i], polygon[i + 1]});
    }
    return true;
  }

  std::vector<Point> points_;
  double circle_tolerance_;
  std::deque<Edge> queue_;
  std::set<Edge> done_;
  Triangles triangles_;
};

bool collinear(const std::vector<Point>& points) {
  std::size_t far = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if ((points[i] - points[0]).length2() > (points[far] - points[0]).length2()) far = i;
  }
  const Point along = points[far] - points[0];
  return std::all_of(points.begin(), points.end(), [&](const Point& p) {
    return std::abs(cross(along, p - points[0])) <= line_tolerance * along.length();
  });
}

}  // namespace

std::vector<std::array<std::uint16_t, 3>> delaunay_triangles(std::span<const Vec2> points) {
  std::vector<Point> exact;
  for (const Vec2& p : points) exact.emplace_back(p.x, p.y);
  if (exact.size() < 3 || collinear(exact)) return {};
  // Rings are cocircular to 1e-7; where another set has a near-tie at one tolerance, a finer one
  // decides it.
  for (const double tolerance : {2e-6, 2e-7, 2e-8, 0.0}) {
    if (auto triangles = Wrapping(exact, tolerance).run()) return *triangles;
  }
  return {};
}

}  // namespace weft
