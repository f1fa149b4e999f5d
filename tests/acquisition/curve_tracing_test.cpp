// Tiles of fibres: repeated without end, and traced like triangles.
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "acquisition/view_tracer.h"
#include "btf/hemisphere_sampling.h"
#include "btf/random.h"
#include "tests/acquisition/known_structures.h"
#include "tests/acquisition/naive_agreement.h"

using namespace weft;

namespace {

constexpr double pi = std::numbers::pi;

/// Two fibres that wind around each other along x, and leave the tile's side.
CurveSet rope(float radius) {
  CurveSet set;
  for (int fibre = 0; fibre < 2; ++fibre) {
    std::vector<CurveSet::Control> strand;
    constexpr int n = 24;
    for (int i = -1; i <= n + 1; ++i) {
      const double t = static_cast<double>(i) / n;
      const double angle = 2 * pi * (2 * t + fibre / 2.0);
      strand.push_back(
          {Vec3(Imath::V3d(t, 0.95 + 0.08 * std::cos(angle),
                           0.2 + 0.08 * std::sin(angle) + 0.03 * std::sin(2 * pi * t))),
           radius});
    }
    set.add_strand(strand, static_cast<std::uint16_t>(fibre));
  }
  return set;
}

Mesostructure rope_over_floor(const Rgb& albedo) {
  Mesostructure m = test::flat(albedo);
  m.materials.push_back(Bsdf::lambert(albedo));
  m.curves = rope(0.05F);
  m.reference_height = 0.36F;
  return m;
}

CurveSet tiled(const CurveSet& tile, int reach) {
  CurveSet patch;
  for (int j = -reach; j <= reach; ++j) {
    for (int i = -reach; i <= reach; ++i) {
      const auto first = static_cast<std::uint32_t>(patch.controls.size());
      for (const auto& [p, radius] : tile.controls) {
        patch.controls.push_back(
            {p + Vec3(static_cast<float>(i), static_cast<float>(j), 0), radius});
      }
      for (const std::uint32_t s : tile.segments) patch.segments.push_back(s + first);
    }
  }
  return patch;
}

Imath::V3d tile_mean(const TracedView& view) {
  Imath::V3d sum(0, 0, 0);
  for (std::size_t i = 0; i < view.values.size(); i += 3)
    sum += Imath::V3d(view.values[i], view.values[i + 1], view.values[i + 2]);
  return sum / (static_cast<double>(view.values.size()) / 3);
}

}  // namespace

TEST_CASE("rays meet the fibres that a wide patch of copies has in their way") {
  const CurveSet tile = rope(0.02F);
  const bool with_floor = GENERATE(false, true);
  const TriangleMesh floor = with_floor ? test::flat(Rgb(1)).mesh : TriangleMesh{};
  const PeriodicScene scene(floor, tile);
  CHECK(scene.top() == Approx(0.318).margin(0.002));
  constexpr int reach = 12;
  const CurveSet wide = tiled(tile, reach);
  const std::array<const CurveSet*, 1> sets{&wide};
  const RayScene patch({}, sets);
  std::int64_t traced_on = 0;
  int compared = 0;
  int different = 0;
  for (std::size_t first = 0; first < 2000; first += lanes) {
    HitPacket rays{};
    RayPacket shadows{};
    for (std::size_t k = 0; k < lanes; ++k) {
      const auto u = [&](int dimension) {
        return unit_float(hash_coordinates(first + k, dimension, 9));
      };
      const Vec3 origin(u(0), u(1), 0.05F + 0.3F * u(2));
      const Direction d = from_spherical(radians(85.0 + 7 * u(3)), 6.28 * u(4));
      rays.ray.set(k, origin, d);
      shadows.set(k, origin, d);
    }
    traced_on += scene.intersect(rays, 0xFFFF, Coherence::incoherent);
    scene.occluded(shadows, 0xFFFF, Coherence::incoherent);
    for (std::size_t k = 0; k < lanes; ++k) {
      const Vec3 origin(rays.ray.ox[k], rays.ray.oy[k], rays.ray.oz[k]);
      const Direction d(rays.ray.dx[k], rays.ray.dy[k], rays.ray.dz[k]);
      const bool hit = rays.mesh[k] != RayHit::none;
      CHECK(hit == (shadows.tfar[k] < 0));
      const RayHit one = scene.intersect(origin, d);
      REQUIRE(hit == one.hit());
      const RayHit expected = patch.intersect(origin, d, 0, 1e9F);
      if (!expected.hit() || expected.distance > reach - 2) continue;
      if (with_floor && (origin + d * expected.distance).z < 0) continue;
      ++compared;
      REQUIRE(hit);
      CHECK(one.primitive == rays.primitive[k]);
      // Segments count on after the triangles.
      const std::size_t segment = rays.primitive[k] - floor.triangles.size();
      REQUIRE(segment < tile.segments.size());
      const Vec3 a = curve_point(tile, segment, rays.u[k], rays.v[k]).normal;
      const Vec3 b = curve_point(wide, expected.primitive, expected.u, expected.v).normal;
      different +=
          segment != expected.primitive % tile.segments.size() || (a - b).length() > 0.05F ? 1 : 0;
    }
  }
  CHECK(traced_on > 100);
  CHECK(compared > 500);
  CHECK(different <= compared / 100);  // grazing a fibre, where rounding decides
}

TEST_CASE("the fast estimator has the plain one's means on fibres") {
  Mesostructure m = rope_over_floor({0.8F, 0.5F, 0.3F});
  m.materials[1] = Bsdf::plastic({0.3F, 0.5F, 0.7F}, 1.5F, 0.4F);
  const test::Agreement a = test::agreement(m, 256, 128);
  INFO("mean z^2 " << a.mean_square_z << ", difference " << a.difference << " +- " << a.deviation);
  CHECK(a.mean_square_z < 1.3);
  CHECK(a.mean_square_z > 0.5);
  CHECK(a.outside < 4e-3);
  CHECK(std::abs(a.difference) < 4 * a.deviation);
}

TEST_CASE("white fibres over a white floor send back all light") {
  const HemisphereSampling lights(named_directions("fibonacci:256"));
  const std::vector<double> solid_angles = lights.solid_angles();
  const ViewTracer tracer(
      rope_over_floor(Rgb(1)), {lights.directions().begin(), lights.directions().end()},
      {.width = 16, .height = 16, .spp = 16, .max_bounces = TraceSettings::unlimited, .seed = 2});
  const TracedView traced = tracer.trace(from_spherical(radians(60.0), 1.0), 5);
  CHECK(traced.statistics.trapped == 0);
  CHECK(traced.statistics.missed == 0);
  double sum = 0;
  for (std::size_t l = 0; l < lights.size(); ++l) {
    for (std::size_t i = 0; i < 256; ++i)
      sum += traced.values[3 * (l * 256 + i)] * solid_angles[l] / 256;
  }
  CHECK(sum == Approx(1).epsilon(0.02));
}

TEST_CASE("the mean of a tile of fibres is reciprocal") {
  const Direction a = from_spherical(radians(35.0), 0.4);
  const Direction b = from_spherical(radians(65.0), 2.9);
  const TraceSettings settings{.width = 16, .height = 16, .spp = 256, .max_bounces = 6, .seed = 4};
  const Mesostructure m = rope_over_floor({0.8F, 0.5F, 0.3F});
  const Imath::V3d ab = tile_mean(ViewTracer(m, {a}, settings).trace(b, 0));
  const Imath::V3d ba = tile_mean(ViewTracer(m, {b}, settings).trace(a, 0));
  for (int c = 0; c < 3; ++c) CHECK(ab[c] * b.z == Approx(ba[c] * a.z).epsilon(0.01));
}

TEST_CASE("the bytes of fibres do not depend on threads") {
  const ViewTracer tracer(rope_over_floor({0.8F, 0.5F, 0.3F}), named_directions("regular:2x6"),
                          {.width = 20, .height = 12, .spp = 5, .max_bounces = 4, .seed = 5});
  const auto with_threads = [&](std::size_t n) {
    const oneapi::tbb::global_control control(oneapi::tbb::global_control::max_allowed_parallelism,
                                              n);
    return tracer.trace(from_spherical(1.0, 0.5), 3);
  };
  const TracedView one = with_threads(1);
  const TracedView four = with_threads(4);
  CHECK(one.values == four.values);
  CHECK(one.statistics.rays() == four.statistics.rays());
}

TEST_CASE("fibres without a floor let rays through, which are counted") {
  Mesostructure m = rope_over_floor(Rgb(0.5F));
  m.mesh.triangles.clear();
  m.mesh.materials.clear();
  const ViewTracer tracer(m, {Direction(0, 0, 1)}, {.width = 16, .height = 16, .spp = 4});
  const TracedView traced = tracer.trace(Direction(0, 0, 1), 0);
  CHECK(traced.statistics.missed > 500);
  CHECK(traced.statistics.missed < 1000);
  CHECK(tile_mean(traced).x > 0.01);
}
