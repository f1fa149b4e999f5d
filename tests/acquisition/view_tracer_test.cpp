// What the virtual gonioreflectometer must answer where the answer is known.
#include "acquisition/view_tracer.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>
#include <thread>

#include "acquisition/acquire.h"
#include "btf/error.h"
#include "btf/raw_appearance.h"
#include "tests/acquisition/known_structures.h"

using namespace weft;

namespace {

constexpr double pi = std::numbers::pi;

// Mean over the texels, of one light.
Imath::V3d tile_mean(const TracedView& view, std::size_t light, std::size_t texels) {
  Imath::V3d sum(0, 0, 0);
  for (std::size_t i = 0; i < texels; ++i) {
    const float* p = &view.values[3 * (light * texels + i)];
    sum += Imath::V3d(p[0], p[1], p[2]);
  }
  return sum / static_cast<double>(texels);
}

Mesostructure painted(Mesostructure structure, const Rgb& albedo) {
  for (Bsdf& material : structure.materials) material = Bsdf::lambert(albedo);
  return structure;
}

// Tile mean integrated over a set of lights.
double albedo_towards(const ViewTracer& tracer, const std::vector<double>& solid_angles,
                      const Direction& view, std::uint64_t key) {
  const TracedView traced = tracer.trace(view, key);
  const auto texels = static_cast<std::size_t>(tracer.settings().width) * tracer.settings().height;
  double sum = 0;
  for (std::size_t l = 0; l < solid_angles.size(); ++l) {
    sum += tile_mean(traced, l, texels).x * solid_angles[l];
  }
  return sum;
}

}  // namespace

TEST_CASE(
    "a flat Lambert tile is rho / pi cos(theta) in every pair, between and beyond the samples") {
  AcquisitionSettings settings;
  settings.trace = {.width = 2, .height = 2, .spp = 2, .max_bounces = 3, .seed = 1};
  const Rgb albedo(0.8F, 0.45F, 0.1F);
  const auto btf = std::make_shared<const Btf>(acquire(test::flat(albedo), settings));
  for (std::size_t v = 0; v < 81; ++v) {
    for (std::size_t l = 0; l < 81; ++l) {
      INFO("view " << v << ", light " << l);
      for (int i = 0; i < 4; ++i) {
        const Rgb found = btf->at(l, v, i % 2, i / 2);
        for (int c = 0; c < 3; ++c) {
          REQUIRE(found[c] == Approx(albedo[c] / pi * btf->lights()[l].z).epsilon(0.002));
        }
      }
    }
  }
  const RawAppearance appearance(btf);
  for (int theta = 0; theta <= 89; ++theta) {
    const Direction light = from_spherical(radians(theta * 1.0), 0.1 * theta);
    const Direction view = from_spherical(radians(89.0 - theta), 2.3 * theta);
    for (const Texcoord& uv : {Texcoord(0.3F, 0.6F), Texcoord(0.9F, 0.1F), Texcoord(0, 0)}) {
      const Rgb found = appearance.evaluate(uv, light, view, 0);
      for (int c = 0; c < 3; ++c) {
        INFO("theta " << theta << ", uv " << uv << ", channel " << c);
        REQUIRE(found[c] == Approx(albedo[c] / pi * light.z).epsilon(0.002));
      }
    }
  }
}

TEST_CASE("a white structure sends back all light", "[heavy]") {
  // The tile's mean integrated over the lights is 1. 65,536 paths a view keep the noise below 0.2
  // %.
  const HemisphereSampling lights(named_directions("fibonacci:1024"));
  const std::vector<double> solid_angles = lights.solid_angles();
  const ViewTracer tracer(painted(test::checker(128), Rgb(1)),
                          {lights.directions().begin(), lights.directions().end()},
                          {.width = 32,
                           .height = 32,
                           .spp = 16,
                           .max_bounces = TraceSettings::unlimited,
                           .views = 1000,
                           .seed = 2});
  REQUIRE(tracer.visibility().rays() > 0);
  for (const double theta : {0.0, 60.0, 89.0}) {
    CHECK(albedo_towards(tracer, solid_angles, from_spherical(radians(theta), 1.0), 5) ==
          Approx(1).epsilon(0.01));
  }
}

TEST_CASE("a hemispherical pit sends back rho / (2 - rho) of what enters it", "[heavy]") {
  // Cavity theory: from any point of the pit half of the pit's sphere is the opening, so that the
  // share is rho / 2 + (rho / 2)^2 ... = rho / (2 - rho). The mesh is a polyhedron inside the
  // sphere: its opening's area is its own.
  constexpr double radius = 0.4;
  constexpr int n = 48;
  const double opening = 0.5 * (4 * n) * radius * radius * std::sin(2 * pi / (4 * n));
  const HemisphereSampling views(named_directions("fibonacci:512"));
  const std::vector<double> solid_angles = views.solid_angles();
  std::vector<Direction> lights;
  for (int i = 0; i < 20; ++i) lights.push_back(from_spherical(radians(4.0 * i), 1.7 * i));
  for (const float rho : {0.5F, 0.9F}) {
    const ViewTracer tracer(
        test::structure(test::pit(radius, n), {Bsdf::lambert(Rgb(rho)), Bsdf::lambert(Rgb(0))}, 0),
        lights,
        {.width = 16,
         .height = 16,
         .spp = 8,
         .max_bounces = TraceSettings::unlimited,
         .views = 1000,
         .seed = 3});
    REQUIRE(tracer.visibility().rays() > 0);
    std::vector<double> sent(lights.size());
    for (std::size_t v = 0; v < views.size(); ++v) {
      const TracedView traced = tracer.trace(views[v], v);
      for (std::size_t l = 0; l < lights.size(); ++l) {
        sent[l] += tile_mean(traced, l, 256).x * views[v].z * solid_angles[v];
      }
    }
    for (std::size_t l = 0; l < lights.size(); ++l) {
      INFO("rho " << rho << ", light " << l);
      CHECK(sent[l] / (lights[l].z * opening) == Approx(rho / (2 - rho)).epsilon(0.005));
    }
  }
}

TEST_CASE("the tile's mean is reciprocal") {
  const Direction a = from_spherical(radians(35.0), 0.4);
  const Direction b = from_spherical(radians(65.0), 2.9);
  const TraceSettings settings{.width = 32, .height = 32, .spp = 64, .max_bounces = 8, .seed = 4};
  const Imath::V3d ab =
      tile_mean(ViewTracer(test::checker(64), {a}, settings).trace(b, 0), 0, 1024);
  const Imath::V3d ba =
      tile_mean(ViewTracer(test::checker(64), {b}, settings).trace(a, 0), 0, 1024);
  for (int c = 0; c < 3; ++c) CHECK(ab[c] * b.z == Approx(ba[c] * a.z).epsilon(0.005));
}

TEST_CASE("the bytes do not depend on threads") {
  // Without a table, and with one that answers for shadows and bounces.
  for (const std::size_t views : {1, 100'000}) {
    const auto with_threads = [&](std::size_t n) {
      const oneapi::tbb::global_control control(
          oneapi::tbb::global_control::max_allowed_parallelism, n);
      const ViewTracer tracer(
          test::checker(64), named_directions("ubo81"),
          {.width = 20, .height = 12, .spp = 5, .max_bounces = 4, .views = views, .seed = 5});
      TracedView traced = tracer.trace(from_spherical(1.0, 0.5), 3);
      traced.statistics.table_rays = tracer.visibility().rays();
      return traced;
    };
    const TracedView one = with_threads(1);
    const TracedView four = with_threads(4);
    CHECK(one.values == four.values);
    CHECK(one.standard_errors == four.standard_errors);
    CHECK(one.statistics.rays() == four.statistics.rays());
    CHECK(one.statistics.open_checked == four.statistics.open_checked);
    CHECK((one.statistics.open_checked > 0) == (views > 1));
  }
}

TEST_CASE("a view is traced whole though another view's task fails meanwhile") {
  const ViewTracer tracer(test::checker(64), named_directions("regular:3x8"),
                          {.width = 64, .height = 64, .spp = 2, .max_bounces = 2, .seed = 5});
  const TracedView expected = tracer.trace({0, 0, 1}, 0);
  std::atomic<bool> started = false;
  TracedView traced;
  const oneapi::tbb::global_control control(oneapi::tbb::global_control::max_allowed_parallelism,
                                            2);
  const auto task = [&](int i) {
    if (i == 0) {
      started = true;
      traced = tracer.trace({0, 0, 1}, 0);
    } else {
      for (int wait = 0; !started && wait < 1000; ++wait) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      throw failed("disk", "is full");
    }
  };
  CHECK_THROWS_AS(tbb::parallel_for(0, 2, task), Error);
  if (started) CHECK(traced.values == expected.values);
}

TEST_CASE("standard errors tell the spread of a pair's mean") {
  // Over 40 seeds, the spread of the means against the stated error: conservative, and not wildly
  // so.
  const TraceSettings settings{.width = 8, .height = 8, .spp = 32, .max_bounces = 4, .seed = 0};
  const ViewTracer tracer(test::checker(64), {from_spherical(0.7, 1.0)}, settings);
  std::vector<double> means;
  double stated = 0;
  for (std::uint64_t run = 0; run < 40; ++run) {
    const TracedView view = tracer.trace(from_spherical(0.9, 4.0), run);
    const Imath::V3d m = tile_mean(view, 0, 64);
    means.push_back((m.x + m.y + m.z) / 3);
    stated += view.standard_errors[0] / 40;
  }
  const double mean = std::accumulate(means.begin(), means.end(), 0.0) / 40;
  double variance = 0;
  for (const double m : means) variance += (m - mean) * (m - mean) / 39;
  CHECK(stated > 0.8 * std::sqrt(variance));
  CHECK(stated < 8 * std::sqrt(variance));
}

TEST_CASE("rays that meet nothing are counted") {
  TriangleMesh half = test::flat(Rgb(1)).mesh;
  for (Vec3& p : half.positions) p.x *= 0.5F;
  const ViewTracer tracer(test::structure(half, {Bsdf::lambert(Rgb(1))}, 0), {{0, 0, 1}},
                          {.width = 16, .height = 16, .spp = 4, .max_bounces = 0, .seed = 6});
  const TracedView view = tracer.trace({0, 0, 1}, 0);
  CHECK(view.statistics.missed == 16 * 16 * 4 / 2);
}

TEST_CASE("what cannot be traced is refused") {
  const auto make = [](std::vector<Direction> lights, TraceSettings settings) {
    return ViewTracer(test::flat(Rgb(1)), std::move(lights), settings);
  };
  CHECK_THROWS_WITH(make({from_spherical(radians(89.95), 0)}, {}),
                    Catch::Contains("light 0") && Catch::Contains("89.9"));
  CHECK_THROWS_WITH(make({}, {}), Catch::Contains("lights"));
  CHECK_THROWS_WITH(make({}, {.views = 1'000'000}), Catch::Contains("lights"));
  CHECK_THROWS_WITH(make({{0, 0, 1}}, {.spp = 0}), Catch::Contains("--spp"));
  CHECK_THROWS_WITH(make({{0, 0, 1}}, {.width = 0}), Catch::Contains("--texels"));
  CHECK_THROWS_AS(make({{0, 0, 1}}, {.max_bounces = -1}), Error);
  CHECK_THROWS_AS(make({{0, 0, 1}}, {}).trace(from_spherical(radians(89.99), 0), 0), Error);
}
