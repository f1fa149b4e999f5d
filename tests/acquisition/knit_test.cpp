// Knitted wool: loops that pass through each other and never meet, without a border, of fibres that
// stay in their yarn.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "acquisition/mesostructure.h"
#include "btf/error.h"
#include "tests/acquisition/mesostructure_files.h"

using namespace weft;
using Catch::Matchers::Contains;

namespace {

using Vec3d = Imath::V3d;

Mesostructure read_knit(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const TemporaryFolder folder;
  return read_mesostructure(write_file(folder, "a.toml", "type = 'knit'\n" + text), overrides);
}

std::string refusal(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    read_knit(text, overrides);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// Yarns that are one smooth tube each: their centre lines are the curves'.
Mesostructure read_smooth(int wales, int courses, double radius) {
  const std::string r = std::to_string(radius);
  return read_knit("", {"stitches=[" + std::to_string(wales) + "," + std::to_string(courses) + "]",
                        "yarn.radius=" + r, "fibre.radius=" + r, "yarn.plies=1", "yarn.fibres=1",
                        "stray=0", "steps=64"});
}

/// Points of the curves' axes, `n` a segment, segment after segment.
std::vector<Vec3d> axes(const CurveSet& curves, int n) {
  std::vector<Vec3d> points;
  for (std::size_t s = 0; s < curves.segments.size(); ++s) {
    for (int k = 0; k < n; ++k) {
      const float u = static_cast<float>(k) / static_cast<float>(n);
      points.push_back(
          Vec3d(curve_point(curves, s, u, 0).position + curve_point(curves, s, u, 0.5F).position) /
          2);
    }
  }
  return points;
}

double wrapped(double x) {
  return x - std::round(x);
}

/// Across the tile's border too.
double distance(const Vec3d& a, const Vec3d& b) {
  return Vec3d(wrapped(a.x - b.x), wrapped(a.y - b.y), a.z - b.z).length();
}

}  // namespace

TEST_CASE("the fibres of a course end where they begin in the next tile") {
  const Mesostructure m = read_knit("", {"stray=0", "stitches=[2, 3]"});
  const std::size_t segments = 2 * 20;  // of a fibre: stitches, steps
  REQUIRE(m.curves.segments.size() == 3 * 3 * 20 * segments);
  double worst = 0;
  for (std::size_t first = 0; first < m.curves.segments.size(); first += segments) {
    for (const float v : {0.0F, 0.4F}) {
      const std::size_t last = first + segments - 1;
      const CurvePoint begin = curve_point(m.curves, first, 0, v);
      // The same place around the end, where the angle may count from another axis.
      const float turn = curve_angle(&m.curves.controls[m.curves.segments[last]], 1, begin.normal);
      const CurvePoint end = curve_point(m.curves, last, 1, turn);
      worst = std::max<double>(worst, (end.position - begin.position - Vec3(1, 0, 0)).length());
      worst = std::max<double>(worst, (end.normal - begin.normal).length() * 1e-2);
    }
  }
  CHECK(worst < 2e-6);
}

TEST_CASE("every loop passes through the one below: over its head, under its legs") {
  const Mesostructure m = read_smooth(2, 3, 0.05);
  constexpr int n = 4;
  const std::vector<Vec3d> points = axes(m.curves, n);
  const std::size_t course = points.size() / 3;
  // Where two courses cross as seen from above, which is higher; from the end of one stitch's head
  // to the next's: a leg over the old loop's head, behind the old loop's legs, and back.
  std::string crossings;
  const std::size_t stitch = course / 2;
  for (std::size_t i = 0; i < stitch; ++i) {
    const Vec3d a = points[course + i];
    const Vec3d b = points[course + i + 1];
    for (std::size_t j = 0; j < course; ++j) {
      const Vec3d c = points[j];
      const Vec3d d = points[(j + 1) % course];
      const Imath::V2d ab(b.x - a.x, b.y - a.y);
      const Imath::V2d cd(wrapped(d.x - c.x), wrapped(d.y - c.y));
      const Imath::V2d ac(wrapped(c.x - a.x), wrapped(c.y - a.y));
      const double area = ab.x * cd.y - ab.y * cd.x;
      const double t = (ac.x * cd.y - ac.y * cd.x) / area;
      const double s = (ac.x * ab.y - ac.y * ab.x) / area;
      if (t < 0 || t >= 1 || s < 0 || s >= 1) continue;
      crossings += a.z > c.z ? 'O' : 'U';
    }
  }
  CHECK(crossings == "OUUO");
}

TEST_CASE("yarns of any radius nearly touch, and do not meet each other or the floor") {
  struct Case {
    int wales, courses;
    double radius;
  };
  for (const auto& [wales, courses, radius] :
       {Case{3, 4, 0.04}, Case{3, 4, 0.041}, Case{2, 3, 0.02}, Case{4, 3, 0.03}, Case{1, 1, 0.1}}) {
    INFO(wales << " x " << courses << ", radius " << radius);
    const Mesostructure m = read_smooth(wales, courses, radius);
    constexpr int n = 2;
    const std::vector<Vec3d> points = axes(m.curves, n);
    const std::size_t course = points.size() / static_cast<std::size_t>(courses);
    std::vector<double> lengths(course + 1);
    for (std::size_t i = 0; i < course; ++i)
      lengths[i + 1] = lengths[i] + distance(points[i], points[(i + 1) % course]);
    double least = 1;
    double lowest = 1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      lowest = std::min(lowest, points[i].z - radius);
      for (std::size_t j = 0; j < i; ++j) {
        if (i / course == j / course) {
          const double apart = std::abs(lengths[i % course] - lengths[j % course]);
          if (std::min(apart, lengths[course] - apart) < 1.2 * 3.1416 * radius) continue;
        }
        least = std::min(least, distance(points[i], points[j]));
      }
    }
    CHECK(least > 1.99 * radius);
    CHECK(least < 2.1 * radius);
    CHECK(lowest > 0);
    CHECK(lowest < 0.2 * radius);
  }
}

TEST_CASE("fibres stay in their yarn, and their radius and number are as asked for") {
  constexpr double radius = 0.03;
  const std::vector<Vec3d> line = axes(read_smooth(2, 3, radius).curves, 4);
  const std::vector<std::string> plain = {"stitches=[2, 3]", "yarn.radius=0.03", "stray=0"};
  for (const char* plies : {"yarn.plies=1", "yarn.plies=4"}) {
    std::vector<std::string> overrides = plain;
    overrides.insert(overrides.end(),
                     {plies, "yarn.fibres=5", "fibre.radius=0.002", "fibre.wander=1"});
    const Mesostructure m = read_knit("", overrides);
    CHECK(m.curves.segments.size() == static_cast<std::size_t>(5 * (plies[11] - '0') * 3 * 2 * 20));
    for (const CurveSet::Control& control : m.curves.controls) CHECK(control.radius == 0.002F);
    double farthest = 0;
    const std::vector<Vec3d> points = axes(m.curves, 1);
    for (std::size_t i = 0; i < points.size(); i += 3) {
      double least = 1;
      for (const Vec3d& p : line) least = std::min(least, distance(points[i], p));
      farthest = std::max(farthest, least);
    }
    CHECK(farthest < 1.04 * (radius - 0.002));  // splines, and points of the line
    CHECK(farthest > 0.8 * (radius - 0.002));
  }
}

TEST_CASE("stray fibres stick out of the yarn, others with another seed") {
  const auto top = [](const std::vector<std::string>& overrides) {
    return read_knit("", overrides).reference_height;
  };
  CHECK(top({"stray=20"}) > top({"stray=0"}) + 0.01F);
  CHECK(top({"stray=20"}) == top({"stray=20"}));
  CHECK(top({"stray=20", "seed=1"}) != top({"stray=20"}));
}

TEST_CASE("a yarn's radius can be set from the command line, and one without room is refused") {
  const float thin = read_knit("", {"yarn.radius=0.02", "stray=0"}).reference_height;
  const float thick = read_knit("", {"yarn.radius=0.04", "stray=0"}).reference_height;
  CHECK(thick > 1.8F * thin);
  CHECK_THAT(refusal("", {"yarn.radius=0.06"}), Contains("--set yarn.radius=0.06") &&
                                                    Contains("'yarn.radius' is 0.06") &&
                                                    Contains("room for at most 0.04"));
  CHECK_THAT(refusal("stitches = [2.5, 3]\n"), Contains("a.toml:2:1") && Contains("[2.5, 3]"));
  CHECK_THAT(refusal("[yarn]\nfibres = 900\n"),
             Contains("a.toml:3:1") && Contains("'yarn.fibres'") && Contains("at most 250000"));
  CHECK_THAT(refusal("", {"yarn.twist=9"}), Contains("'yarn.twist' is 9"));
  CHECK_THAT(refusal("", {"fibre.wonder=1"}), Contains("did you mean 'fibre.wander'"));
}

TEST_CASE("an offset shifts the fibres too") {
  const Mesostructure plain = read_knit("");
  const Mesostructure moved = read_knit("", {"offset=[0.25, 0.5]"});
  REQUIRE(plain.curves.controls.size() == moved.curves.controls.size());
  const Vec3 shift = moved.curves.controls[7].position - plain.curves.controls[7].position;
  CHECK((shift - Vec3(0.25F, 0.5F, 0)).length() < 1e-6F);
}
