#include "acquisition/mesostructures/stone.h"

#include <cmath>
#include <map>
#include <numbers>

#include "acquisition/mesostructures/noise.h"
#include "btf/random.h"

namespace weft {

namespace {

using Vec3d = Imath::V3d;

struct Sphere {
  std::vector<Vec3d> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

Sphere icosahedron() {
  const double g = std::numbers::phi;
  Sphere sphere;
  sphere.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3d& p : sphere.points) p.normalize();
  sphere.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return sphere;
}

/// Each triangle in four, the new points on the sphere.
void subdivide(Sphere& sphere) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto fresh = static_cast<std::uint32_t>(sphere.points.size());
    const auto [found, added] = middles.try_emplace(std::minmax(a, b), fresh);
    if (added) sphere.points.push_back((sphere.points[a] + sphere.points[b]).normalized());
    return found->second;
  };
  std::vector<std::array<std::uint32_t, 3>> finer;
  for (const auto& [a, b, c] : sphere.triangles) {
    const std::uint32_t ab = middle(a, b);
    const std::uint32_t bc = middle(b, c);
    const std::uint32_t ca = middle(c, a);
    for (const auto& t : {std::array{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}})
      finer.push_back(t);
  }
  sphere.triangles = std::move(finer);
}

/// Random numbers in [0, 1), one after another.
class Sequence {
 public:
  explicit Sequence(std::uint64_t seed) : seed_(seed) {}
  double next() { return unit_float(hash_coordinates(seed_, index_++)); }
  double next(double from, double to) { return from + (to - from) * next(); }

 private:
  std::uint64_t seed_;
  int index_ = 0;
};

/// Normals over plane distances, n_k / c_k: evenly around, but for chance, so that the body is
/// closed.
std::vector<Vec3d> random_planes(Sequence& random) {
  constexpr int count = 18;
  std::vector<Vec3d> planes;
  for (int k = 0; k < count; ++k) {
    // A Fibonacci spiral.
    const double z = 1 - (2 * k + 1.0) / count;
    const double angle = 2 * std::numbers::pi * k * std::numbers::phi;
    const double across = std::sqrt(1 - z * z);
    const Vec3d even(across * std::cos(angle), across * std::sin(angle), z);
    const Vec3d chance(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1));
    planes.push_back((even + 0.4 * chance).normalized() / random.next(0.7, 1));
  }
  return planes;
}

double surface_distance(const std::vector<Vec3d>& planes, const Vec3d& direction, double power) {
  double sum = 0;
  for (const Vec3d& plane : planes) sum += std::pow(std::max(0.0, direction.dot(plane)), power);
  return std::pow(sum, -1 / power);
}

/// `p` turned about x by a small tilt, then about z.
Vec3d turned(const Vec3d& p, double tilt, double turn) {
  const double y = p.y * std::cos(tilt) - p.z * std::sin(tilt);
  const double z = p.y * std::sin(tilt) + p.z * std::cos(tilt);
  return {p.x * std::cos(turn) - y * std::sin(turn), p.x * std::sin(turn) + y * std::cos(turn), z};
}

}  // namespace

TriangleMesh make_stone(const StoneForm& form, int levels, std::uint64_t seed) {
  Sphere sphere = icosahedron();
  for (int level = 0; level < levels; ++level) subdivide(sphere);
  Sequence random(seed);
  const std::vector<Vec3d> planes = random_planes(random);
  const double shortest = 1 - form.flatness;
  const Vec3d axes(1, random.next(shortest, 1), shortest);
  const double tilt = random.next(-0.35, 0.35);
  const double turn = random.next(0, 2 * std::numbers::pi);

  TriangleMesh mesh;
  mesh.triangles = sphere.triangles;
  for (const Vec3d& direction : sphere.points) {
    const double bump = 1 + form.bumps * (space_noise(direction * 3.0, seed) +
                                          0.5 * space_noise(direction * 7.0, seed + 1));
    const double distance = surface_distance(planes, direction, 4 / form.roundness);
    const Vec3d p = direction * (form.radius * distance * bump);
    mesh.positions.emplace_back(turned(p * axes, tilt, turn));
  }
  return mesh;
}

}  // namespace weft
