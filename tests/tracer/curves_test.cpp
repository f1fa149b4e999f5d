// Round fibres against formulas: cylinders, cones, and a ring whose distance can be told.
#include "tracer/curves.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "btf/error.h"
#include "btf/random.h"
#include "tracer/ray_scene.h"

using namespace weft;

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr double pi = std::numbers::pi;

/// Evenly spaced controls on a line from x = 0 on: that line, and a radius that grows evenly.
CurveSet straight(float radius, float growth) {
  std::vector<CurveSet::Control> strand;
  for (int i = -1; i <= 11; ++i) {
    const float x = 0.1F * static_cast<float>(i);
    strand.push_back({Vec3(x, 0.2F, 0.3F), radius + growth * x});
  }
  CurveSet set;
  set.add_strand(strand, 0);
  return set;
}

/// A ring around z, nearly a torus of major radius 0.3.
CurveSet ring(float radius) {
  std::vector<CurveSet::Control> strand;
  constexpr int n = 24;
  for (int i = 0; i < n + 3; ++i) {
    const double phi = 2 * pi * i / n;
    // Controls lie outside of the circle that the spline follows.
    const double r = 0.3 * 3 / (2 + std::cos(2 * pi / n));
    strand.push_back({Vec3(Imath::V3d(r * std::cos(phi), r * std::sin(phi), 0)), radius});
  }
  CurveSet set;
  set.add_strand(strand, 0);
  return set;
}

RayScene scene_of(const CurveSet& set) {
  const std::array<const CurveSet*, 1> sets{&set};
  return RayScene({}, sets);
}

struct Ray {
  Vec3 origin, direction;
};
Ray random_ray(std::uint64_t i) {
  const auto u = [&](int k) { return unit_float(hash_coordinates(i, k, 77)); };
  const Vec3 from(2 * u(0) - 0.5F, 2 * u(1) - 0.8F, 1.5F);
  const Vec3 to(u(2), 0.2F + 0.06F * (u(3) - 0.5F), 0.3F + 0.06F * (u(4) - 0.5F));
  return {from, (to - from).normalized()};
}

}  // namespace

TEST_CASE("a strand's segments join: the same point and normal from both sides") {
  const CurveSet set = ring(0.02F);
  REQUIRE(set.segments.size() == 24);
  for (std::size_t s = 0; s < 24; ++s) {
    for (const float v : {0.0F, 0.3F, 0.9F}) {
      const CurvePoint end = curve_point(set, s, 1, v);
      const CurvePoint begin = curve_point(set, (s + 1) % 24, 0, v);
      CHECK((end.position - begin.position).length() < 1e-6F);
      CHECK((end.normal - begin.normal).length() < 1e-5F);
    }
  }
}

TEST_CASE("rays meet a straight fibre where a cylinder is, and its normal") {
  constexpr float radius = 0.02F;
  const CurveSet set = straight(radius, 0);
  const RayScene scene = scene_of(set);
  int hits = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const auto [origin, direction] = random_ray(i);
    const RayHit hit = scene.intersect(origin, direction, 0, infinity);
    // Across the axis: |o + t d - axis| = radius.
    const Imath::V2d o(origin.y - 0.2F, origin.z - 0.3F);
    const Imath::V2d d(direction.y, direction.z);
    const double half = o.dot(d);
    const double root = half * half - d.length2() * (o.length2() - radius * radius);
    const double t = (-half - std::sqrt(std::max(root, 0.0))) / d.length2();
    const double x = origin.x + t * direction.x;
    if (std::abs(root) < 1e-6 || std::abs(x) < 1e-3 || std::abs(x - 1) < 1e-3) continue;
    const bool expected = root > 0 && x > 0 && x < 1;
    if (!expected && (x < 0 || x > 1)) continue;  // may come in by an open end
    REQUIRE(hit.hit() == expected);
    CHECK(scene.occluded(origin, direction, 0, infinity) == expected);
    if (!expected) continue;
    ++hits;
    CHECK(hit.distance == Approx(t).margin(1e-5));
    const CurvePoint point = curve_point(set, hit.primitive, hit.u, hit.v);
    const Vec3 met = origin + direction * static_cast<float>(t);
    CHECK((point.position - met).length() < 2e-6F);
    const Vec3 normal = Vec3(0, met.y - 0.2F, met.z - 0.3F).normalized();
    CHECK((point.normal - normal).length() < 1e-3F);
  }
  CHECK(hits > 500);
}

TEST_CASE("a fibre that widens has the normals of a cone") {
  constexpr float growth = 0.05F;
  const CurveSet set = straight(0.02F, growth);
  for (const float u : {0.0F, 0.4F, 1.0F}) {
    for (const float v : {0.1F, 0.6F}) {
      const CurvePoint point = curve_point(set, 3, u, v);
      const float x = 0.3F + 0.1F * u;
      const Vec3 across(0, point.position.y - 0.2F, point.position.z - 0.3F);
      CHECK(point.position.x == Approx(x));
      CHECK(across.length() == Approx(0.02F + growth * x).epsilon(1e-4));
      const Vec3 normal = (across.normalized() - Vec3(growth, 0, 0)).normalized();
      CHECK((point.normal - normal).length() < 1e-4F);
      CHECK(curve_angle(&set.controls[3], u, point.normal) == Approx(v).epsilon(1e-4));
    }
  }
}

TEST_CASE("single rays, streams and packets name the same points of curves, and of meshes before") {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.materials = {0, 0};
  const CurveSet set = straight(0.02F, 0);
  const std::array<const TriangleMesh*, 1> meshes{&mesh};
  const std::array<const CurveSet*, 1> sets{&set};
  const RayScene scene(meshes, sets);
  constexpr std::size_t n = 640;
  RayStream stream;
  stream.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto [origin, direction] = random_ray(i);
    stream.set(i, origin, direction, 0, infinity);
  }
  scene.intersect(stream, n, Coherence::incoherent);
  int on_curve = 0;
  int on_mesh = 0;
  for (std::size_t first = 0; first < n; first += lanes) {
    HitPacket packet{};
    for (std::size_t k = 0; k < lanes; ++k) {
      const auto [origin, direction] = random_ray(first + k);
      packet.ray.set(k, origin, direction);
      packet.ray.tfar[k] = infinity;
    }
    scene.intersect(packet, 0xFFFF, Coherence::coherent);
    for (std::size_t k = 0; k < lanes; ++k) {
      const auto [origin, direction] = random_ray(first + k);
      const RayHit one = scene.intersect(origin, direction, 0, infinity);
      REQUIRE(one.mesh == packet.mesh[k]);
      REQUIRE(one.mesh == stream.mesh[first + k]);
      if (!one.hit()) continue;
      ++(one.mesh == 0 ? on_mesh : on_curve);
      CHECK(one.primitive == packet.primitive[k]);
      CHECK(one.v == Approx(packet.v[k]).margin(1e-3));
      CHECK(one.v == Approx(stream.v[first + k]).margin(1e-3));
      CHECK(one.u == Approx(packet.u[k]).margin(1e-4));
      if (one.mesh == 1) {
        const CurvePoint point = curve_point(set, one.primitive, one.u, one.v);
        CHECK((point.position - origin - direction * one.distance).length() < 1e-5F);
      }
    }
  }
  CHECK(on_curve > 100);
  CHECK(on_mesh > 50);
}

TEST_CASE("a ray that leaves a bent fibre does not meet it where it began") {
  // The step off the surface is that of the tracer: 3e-6 of the tile. Outside of the ring nothing
  // is in the way; grazing rays towards its hole may meet it again, but never from inside.
  const CurveSet set = ring(0.004F);
  const RayScene scene = scene_of(set);
  int hits = 0;
  int wrong = 0;
  for (std::uint64_t i = 0; i < 40'000; ++i) {
    const auto u = [&](int k) { return unit_float(hash_coordinates(i, k, 5)); };
    const std::size_t segment = i % set.segments.size();
    const CurvePoint point = curve_point(set, segment, u(0), u(1));
    Vec3 direction = Vec3(2 * u(2) - 1, 2 * u(3) - 1, 2 * u(4) - 1).normalized();
    if ((direction ^ point.normal) < 0) direction = -direction;
    if (i % 2 == 0)  // grazing
      direction = (direction - point.normal * ((direction ^ point.normal) * 0.999F)).normalized();
    const Vec3 origin = point.position + point.normal * 3e-6F;
    const RayHit hit = scene.intersect(origin, direction, 0, infinity);
    if (!hit.hit()) continue;
    ++hits;
    const CurvePoint met = curve_point(set, hit.primitive, hit.u, hit.v);
    wrong += (met.normal ^ direction) > 0 ? 1 : 0;
    const Vec3 away(point.position.x, point.position.y, 0);
    wrong += (away ^ direction) > 0 && (away ^ point.normal) > 0 ? 1 : 0;
  }
  CHECK(hits > 100);
  CHECK(wrong == 0);
}

TEST_CASE("the bounds hold a fibre and touch it") {
  const Bounds bounds = bounds_of(ring(0.02F));
  for (int axis = 0; axis < 2; ++axis) {
    CHECK(bounds.high[axis] == Approx(0.32F).epsilon(1e-3));
    CHECK(bounds.low[axis] == Approx(-0.32F).epsilon(1e-3));
  }
  CHECK(bounds.high.z == Approx(0.02F));
  CHECK(bounds.low.z == Approx(-0.02F));
  // The highest point between two controls.
  CurveSet arch;
  arch.add_strand(
      std::vector<CurveSet::Control>{
          {{0, 0, 0}, 0.1F}, {{1, 0, 6}, 0.1F}, {{2, 0, 6}, 0.1F}, {{3, 0, 0}, 0.1F}},
      0);
  CHECK(bounds_of(arch).high.z == Approx(5.75 + 0.1));
  CHECK(bounds_of(arch).low.z == Approx(5 - 0.1));
  CHECK(bounds_of(CurveSet{}).high.z < bounds_of(CurveSet{}).low.z);
}

TEST_CASE("a curve that is not finite is refused, and a negative radius") {
  CurveSet set = straight(0.02F, 0);
  set.controls[4].position.y = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_WITH(scene_of(set), Catch::Contains("control 4 is not finite"));
  CHECK_THROWS_WITH(scene_of(straight(-0.02F, 0)), Catch::Contains("its radius is negative"));
}
