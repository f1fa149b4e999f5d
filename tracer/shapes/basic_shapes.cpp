#include "tracer/shapes/basic_shapes.h"

#include <cmath>
#include <numbers>

#include "btf/error.h"
#include "tracer/mesh_file.h"
#include "tracer/shapes/parametric_surface.h"

namespace weft {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;
constexpr double largest = 1e6;

double length(const Settings& settings, const std::string& key, double fallback) {
  const double value = settings.number(key, fallback, 0, largest);
  if (value == 0) throw bad_input(settings.where(key), key + " is 0, expected a length above 0");
  return value;
}

Vec3 vec3(double x, double y, double z) {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

/// A rectangle centred at `centre` whose half sides are `u` and `v`; it faces u x v.
TriangleMesh rectangle(const Vec3& centre, const Vec3& u, const Vec3& v) {
  const Vec3 normal = u.cross(v).normalized();
  return tessellate(1, 1, [&](int column, int row) {
    const Vec3 p = centre + u * (2.0F * column - 1) + v * (2.0F * row - 1);
    return SurfacePoint{p, normal, u.normalized(), Vec2(column, row)};
  });
}

}  // namespace

TriangleMesh make_plane(const Settings& settings) {
  const Vec2 size = settings.vec2("size", {2, 2});
  if (!(size.x > 0 && size.y > 0)) throw bad_input(settings.where("size"), "size is not above 0");
  return rectangle({0, 0, 0}, {size.x / 2, 0, 0}, {0, size.y / 2, 0});
}

TriangleMesh make_cube(const Settings& settings) {
  const auto h = static_cast<float>(length(settings, "size", 2) / 2);
  TriangleMesh cube;
  // The four sides stand upright: v along +z. The lid's v looks along +y, the bottom's along -y.
  append(cube, rectangle({h, 0, 0}, {0, h, 0}, {0, 0, h}));
  append(cube, rectangle({0, h, 0}, {-h, 0, 0}, {0, 0, h}));
  append(cube, rectangle({-h, 0, 0}, {0, -h, 0}, {0, 0, h}));
  append(cube, rectangle({0, -h, 0}, {h, 0, 0}, {0, 0, h}));
  append(cube, rectangle({0, 0, h}, {h, 0, 0}, {0, h, 0}));
  append(cube, rectangle({0, 0, -h}, {h, 0, 0}, {0, -h, 0}));
  return cube;
}

TriangleMesh make_sphere(const Settings& settings) {
  const double radius = length(settings, "radius", 1);
  const auto segments = static_cast<int>(settings.integer("segments", 128, 4, 8192));
  const int rings = segments / 2;
  return tessellate(segments, rings, [&](int column, int row) {
    const double u = static_cast<double>(column) / segments;
    const double v = static_cast<double>(row) / rings;
    // Seam and poles meet exactly: the last column is the first one's, poles have a radius of zero.
    const double phi = column == segments ? 0 : two_pi * u;
    const double r = row == 0 || row == rings ? 0 : std::sin(std::numbers::pi * v);
    const Vec3 n = vec3(r * std::cos(phi), r * std::sin(phi), -std::cos(std::numbers::pi * v));
    return SurfacePoint{n * static_cast<float>(radius), n.normalized(),
                        vec3(-std::sin(phi), std::cos(phi), 0), Vec2(u, v)};
  });
}

TriangleMesh make_torus(const Settings& settings) {
  const double major = length(settings, "major", 1);
  const double minor = length(settings, "minor", 0.4);
  if (minor > major) {
    throw bad_input(settings.where("minor"), "the tube's radius is larger than the circle's");
  }
  const auto segments = static_cast<int>(settings.integer("segments", 256, 3, 16384));
  const auto tube_segments = static_cast<int>(settings.integer("tube_segments", 96, 3, 16384));
  return tessellate(segments, tube_segments, [&](int column, int row) {
    const double u = static_cast<double>(column) / segments;
    const double v = static_cast<double>(row) / tube_segments;
    const double a = column == segments ? 0 : two_pi * u;
    const double b = row == tube_segments ? 0 : two_pi * v;
    const double r = major + minor * std::cos(b);
    return SurfacePoint{vec3(r * std::cos(a), r * std::sin(a), minor * std::sin(b)),
                        vec3(std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b)),
                        vec3(-std::sin(a), std::cos(a), 0), Vec2(u, v)};
  });
}

TriangleMesh make_file_mesh(const Settings& settings) {
  TriangleMesh mesh = read_mesh(settings.existing_path("file"));
  complete_frames(mesh);
  return mesh;
}

}  // namespace weft
