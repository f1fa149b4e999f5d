#include "tracer/shapes/seashell.h"

#include <Imath/ImathVec.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "btf/error.h"
#include "tracer/shapes/parametric_surface.h"

namespace weft {
namespace {

using Vec3d = Imath::V3d;
constexpr double pi = std::numbers::pi;

/// The symbols of the header's formula. The aperture lies at t = 0, the apex far below 0.
struct Spiral {
  double k, a, b, c, h;
};

/// One ring of the tube, and the derivatives of (t, w) along the shell, towards the aperture.
struct Ring {
  double t, w, dt, dw;
};

constexpr double lip = 0.07;        ///< radius of the rounded lip over the tube's own
constexpr double bowl_depth = 0.7;  ///< radians of t that the bowl reaches back
constexpr int lip_rings = 12;
constexpr int bowl_rings = 32;
constexpr int apex_rings = 8;
constexpr double apex_length = 0.35;  ///< radians of t over which the tube opens at the apex

/// The tube from its pointed start over the whorls and the lip to the bowl's bottom.
std::vector<Ring> rings_of(double whorls, int segments) {
  std::vector<Ring> rings;
  const double start = -2 * pi * whorls;
  for (int i = 0; i < apex_rings; ++i) {  // a quarter of an ellipse
    const double x = 0.5 * pi * i / apex_rings;
    rings.push_back({start + apex_length * (1 - std::cos(x)), std::sin(x),
                     apex_length * std::sin(x), std::cos(x)});
  }
  const int along = std::max(1, static_cast<int>(std::lround(whorls * segments)));
  for (int i = 0; i <= along; ++i) {
    const double first = start + apex_length;
    rings.push_back({first * (1 - static_cast<double>(i) / along), 1, 1, 0});
  }
  for (int i = 1; i <= lip_rings; ++i) {  // half a circle, inwards
    const double x = pi * i / lip_rings;
    rings.push_back(
        {lip * std::sin(x), 1 - lip + lip * std::cos(x), lip * std::cos(x), -lip * std::sin(x)});
  }
  const double mouth = 1 - 2 * lip;
  for (int i = 1; i <= bowl_rings; ++i) {  // a quarter of an ellipse, back into the shell
    const double x = 0.5 * pi * i / bowl_rings;
    const double w = i == bowl_rings ? 0 : mouth * std::cos(x);
    rings.push_back(
        {-bowl_depth * std::sin(x), w, -bowl_depth * std::cos(x), -mouth * std::sin(x)});
  }
  return rings;
}

struct Derivatives {
  Vec3d p, dt, dw, ds;
};

Derivatives derivatives(const Spiral& spiral, double t, double w, double s) {
  const auto& [k, a, b, c, h] = spiral;
  const double grown = std::exp(k * t);
  const Vec3d radial(std::cos(t), std::sin(t), 0), around(-std::sin(t), std::cos(t), 0), z(0, 0, 1);
  const double r = a + w * b * std::cos(s);
  const Vec3d p = grown * (r * radial + (w * c * std::sin(s) - h) * z);
  return {p, k * p + grown * r * around, grown * (b * std::cos(s) * radial + c * std::sin(s) * z),
          grown * w * (-b * std::sin(s) * radial + c * std::cos(s) * z)};
}

/// Where the tube's width is zero every s is the same point, and the normal is along the spiral.
SurfacePoint surface_point(const Spiral& spiral, const Ring& ring, double s, const Vec2& texcoord) {
  const Derivatives d = derivatives(spiral, ring.t, ring.w, s);
  const Vec3d along = d.dt * ring.dt + d.dw * ring.dw;
  // At a pole dP/ds vanishes as w does; its direction is the limit's.
  const Vec3d around = ring.w > 0 ? d.ds : derivatives(spiral, ring.t, 1, s).ds;
  return {Vec3(d.p), Vec3(along.cross(around).normalized()), Vec3(along.normalized()), texcoord};
}

Spiral read_spiral(const Settings& settings) {
  const double growth = settings.number("growth", 1.9, 1.01, 100);
  const Vec2 tube = settings.vec2("tube", {0.85F, 0.95F});
  const double radius = settings.number("radius", 0.9, 1e-6, 1e6);
  if (!(tube.x > 0 && tube.y > 0))
    throw bad_input(settings.where("tube"), "a half axis is not above 0");
  if (tube.x > radius) {
    throw bad_input(settings.where("tube"),
                    "the tube's first half axis is larger than the spiral's radius");
  }
  return {std::log(growth) / (2 * pi), radius, tube.x, tube.y,
          settings.number("height", 2.2, 0, 1e6)};
}

}  // namespace

TriangleMesh make_seashell(const Settings& settings) {
  const Spiral spiral = read_spiral(settings);
  const double whorls = settings.number("whorls", 4.5, 0.25, 32);
  const auto segments = static_cast<int>(settings.integer("segments", 96, 4, 4096));
  const auto tube_segments = static_cast<int>(settings.integer("tube_segments", 96, 4, 4096));
  const std::vector<Ring> rings = rings_of(whorls, segments);

  // u counts turns along the tube, and goes on over the lip and into the bowl by the way travelled
  // there.
  std::vector<double> u(rings.size(), 0);
  for (std::size_t i = 1; i < rings.size(); ++i) {
    const double dt = rings[i].t - rings[i - 1].t;
    const double dw = (rings[i].w - rings[i - 1].w) * spiral.b / (spiral.a + spiral.b);
    u[i] = u[i - 1] + std::hypot(dt, dw) / (2 * pi);
  }
  const auto columns = static_cast<int>(rings.size()) - 1;
  return tessellate(columns, tube_segments, [&](int column, int row) {
    const double v = static_cast<double>(row) / tube_segments;
    const double s = row == tube_segments ? -pi : 2 * pi * v - pi;  // the seam hides at the axis
    return surface_point(spiral, rings[column], s, Vec2(u[column], v));
  });
}

}  // namespace weft
