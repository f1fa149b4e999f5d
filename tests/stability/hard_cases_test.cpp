// Structures, directions and materials at the edge of what floats can bear: finite, non-negative,
// and what a formula or the plain tracer answers.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <numbers>
#include <vector>

#include "acquisition/mesostructure.h"
#include "acquisition/naive_tracer.h"
#include "acquisition/view_tracer.h"
#include "btf/hemisphere_sampling.h"
#include "tests/acquisition/known_structures.h"
#include "tests/stability/direct_light.h"
#include "tests/statistics.h"
#include "tests/temporary_folder.h"

using namespace weft;

namespace {

Direction at(double theta, double phi) {
  return from_spherical(radians(theta), radians(phi));
}

// As of so many views that the visibility table is worth its rays.
TraceSettings settings(int size, int spp, int max_bounces) {
  return {.width = size,
          .height = size,
          .spp = spp,
          .max_bounces = max_bounces,
          .views = 1'000'000,
          .texel_errors = true,
          .seed = 11};
}

// The given light among those of ubo81, without which the table knows nothing of bounces; what is
// returned is the given one's alone.
TracedView trace(const Mesostructure& structure, const Direction& view, const Direction& light,
                 const TraceSettings& s) {
  std::vector<Direction> lights = named_directions("ubo81");
  lights.insert(lights.begin(), light);
  TracedView traced = ViewTracer(structure, lights, s).trace(view, 1);
  for (const float value : traced.values) {
    REQUIRE(std::isfinite(value));
    REQUIRE(value >= 0);
  }
  CHECK(traced.statistics.invalid == 0);
  const std::size_t one = traced.values.size() / lights.size();
  traced.values.resize(one);
  traced.texel_errors.resize(one);
  return traced;
}

// The tile's mean against the plain tracer's, channel by channel, within 4.5 joint standard errors.
// Returns the fast one's (green).
double agree(const Mesostructure& structure, const Direction& view, const Direction& light,
             const TraceSettings& s) {
  const TracedView fast = trace(structure, view, light, s);
  const NaiveEstimate plain = trace_pair_naively(TraceableStructure(structure), s, view, light, 99);
  REQUIRE(plain.values.size() == fast.values.size());
  const auto texels = static_cast<double>(fast.values.size()) / 3;
  double green = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    double ours = 0, theirs = 0, variance = 0;
    for (std::size_t i = c; i < fast.values.size(); i += 3) {
      ours += fast.values[i] / texels;
      theirs += plain.values[i] / texels;
      variance += (std::pow(fast.texel_errors[i], 2) + plain.variances[i]) / (texels * texels);
    }
    INFO("theta_view " << degrees(theta_of(view)) << ", theta_light " << degrees(theta_of(light))
                       << ", channel " << c << ": " << ours << " against " << theirs << " +- "
                       << std::sqrt(variance));
    CHECK(theirs > 0);
    CHECK(std::sqrt(variance) < 0.1 * theirs);  // else agreeing would say nothing
    CHECK(std::abs(ours - theirs) < 4.5 * std::sqrt(variance) + 1e-5 * theirs);
    if (c == 1) green = ours;
  }
  return green;
}

void expect_flat(const Mesostructure& structure, double albedo, const Direction& view,
                 const Direction& light) {
  for (const float value : trace(structure, view, light, settings(8, 8, 8)).values)
    REQUIRE(value == Approx(albedo / std::numbers::pi * light.z).epsilon(1e-4));
}

Mesostructure painted(Mesostructure structure, float albedo) {
  for (Bsdf& material : structure.materials) material = Bsdf::lambert(Rgb(albedo));
  return structure;
}

// Texel by texel against the brute force: neither shares a line with the tracer above Embree.
void agree_directly(const Mesostructure& structure, const std::vector<double>& albedo,
                    const Direction& view, const Direction& light, double tolerance = 0.002) {
  constexpr int size = 16;
  const std::vector<double> expected = test::direct_light(structure, albedo, view, light, size, 32);
  const TracedView traced = trace(structure, view, light, settings(size, 1024, 0));
  double mean = 0;
  double difference = 0;
  double squares = 0;
  for (std::size_t t = 0; t < expected.size(); ++t) {
    const double d = traced.values[3 * t + 1] - expected[t];
    mean += expected[t] / (size * size);
    difference += d / (size * size);
    squares += d * d / (size * size);
  }
  INFO("theta_view " << degrees(theta_of(view)) << ", theta_light " << degrees(theta_of(light))
                     << ": relative difference of the means " << difference / mean
                     << ", root mean square of the texels' " << std::sqrt(squares) / mean);
  CHECK(mean > 0);
  CHECK(std::abs(difference) < tolerance * mean);
  CHECK(std::sqrt(squares) < 10 * tolerance * mean);
}

// A spherical pit of albedo rho, open in a share a of its sphere, in a black rim. What a point of a
// sphere reflects falls evenly on all of it: so with opening area A and sphere's area S the part of
// the tile's mean of k >= 1 reflections after the first is A^2 cos(theta_light) rho^2 / (pi S)
// (rho (1 - a))^(k - 1).
class Cavity {
 public:
  Cavity(double radius, double half_opening, float rho)
      : rho_(rho),
        kept_(rho * (1 + std::cos(half_opening)) / 2),
        structure_(test::structure(test::pit(radius, rows, half_opening),
                                   {Bsdf::lambert(Rgb(rho)), Bsdf::lambert(Rgb(0))}, 0)) {
    const double r = radius * std::sin(half_opening);
    const double opening = 0.5 * around * r * r * std::sin(2 * std::numbers::pi / around);
    scale_ = opening * opening * light_.z * rho_ * rho_ /
             (4 * std::numbers::pi * std::numbers::pi * radius * radius);
  }

  /// The tile's mean with up to `most` reflections after the first less that with up to `least`.
  double expected(int most, int least) const {
    return scale_ * (std::pow(kept_, least) - std::pow(kept_, most)) / (1 - kept_);
  }

  /// Held against the tracer, which draws the same paths for both.
  void agrees(int most, int least, int runs, int spp) const {
    constexpr int size = 16;
    TraceSettings s = settings(size, spp, most);
    const ViewTracer far(structure_, {light_}, s);
    s.max_bounces = least;
    const ViewTracer near(structure_, {light_}, s);
    std::vector<double> differences;
    double mean = 0;
    for (int run = 0; run < runs; ++run) {
      const TracedView a = far.trace(view_, run);
      const TracedView b = near.trace(view_, run);
      differences.push_back(0);
      for (std::size_t i = 0; i < a.values.size(); i += 3)
        differences.back() += (static_cast<double>(a.values[i]) - b.values[i]) / (size * size);
      mean += differences.back() / runs;
    }
    double variance = 0;
    for (const double d : differences) variance += std::pow(d - mean, 2) / (runs - 1) / runs;
    INFO(least << " to " << most << " bounces: " << mean << " +- " << std::sqrt(variance)
               << ", expected " << expected(most, least));
    CHECK(std::sqrt(variance) < 0.04 * mean);
    CHECK(statistics::t_test(differences, expected(most, least)) > 1e-3);
  }

 private:
  static constexpr int rows = 32;
  static constexpr int around = 4 * rows;
  Direction view_ = at(25, 20);
  Direction light_ = at(40, 80);
  double rho_;
  double kept_;
  double scale_ = 0;
  Mesostructure structure_;
};

}  // namespace

TEST_CASE("theta of 89 degrees, of light and of view") {
  expect_flat(test::flat(Rgb(0.5F)), 0.5, at(89, 10), at(89, 200));
  agree(test::checker(64), at(89, 30), at(40, 100), settings(16, 256, 4));
  agree(test::checker(64), at(40, 100), at(89, 30), settings(32, 1024, 4));
  agree(test::checker(64), at(89, 30), at(89, 75), settings(16, 1024, 4));
  agree_directly(test::checker(16), {0.45, 0.2}, at(89, 30), at(40, 100));
  agree_directly(test::checker(16), {0.45, 0.2}, at(40, 100), at(89, 30), 0.015);  // little is lit
}

TEST_CASE("a spike a hundred times as high as wide") {
  Mesostructure spike = test::flat(Rgb(0.6F));
  TriangleMesh& mesh = spike.mesh;
  for (const Vec3& p : {Vec3(0.495F, 0.495F, 0), Vec3(0.505F, 0.495F, 0), Vec3(0.505F, 0.505F, 0),
                        Vec3(0.495F, 0.505F, 0), Vec3(0.5F, 0.5F, 1)})
    mesh.positions.push_back(p);
  for (std::uint32_t i = 0; i < 4; ++i) {
    mesh.triangles.push_back({4 + i, 4 + (i + 1) % 4, 8});
    mesh.materials.push_back(0);
  }
  spike.reference_height = 1;
  agree(spike, at(60, 20), at(45, 200), settings(16, 256, 4));
  agree(spike, at(85, 20), at(75, 70), settings(16, 256, 4));
  agree_directly(spike, {0.6}, at(60, 20), at(45, 200));
  agree_directly(spike, {0.6}, at(85, 20), at(75, 70));
}

TEST_CASE("a fence without thickness, along which light and view pass for tiles") {
  Mesostructure fence = test::flat(Rgb(0.6F));
  TriangleMesh& mesh = fence.mesh;
  for (const Vec3& p : {Vec3(0.5F, 0, 0), Vec3(0.5F, 1, 0), Vec3(0.5F, 1, 1), Vec3(0.5F, 0, 1)})
    mesh.positions.push_back(p);
  mesh.triangles.push_back({4, 5, 6});
  mesh.triangles.push_back({4, 6, 7});
  mesh.materials.insert(mesh.materials.end(), {0, 0});
  fence.reference_height = 1;
  agree_directly(fence, {0.6}, at(10, 90), at(75, 80));
  agree_directly(fence, {0.6}, at(84, 96), at(40, 150));
}

TEST_CASE("coincident and degenerate triangles") {
  Mesostructure structure = test::flat(Rgb(0.7F));
  TriangleMesh& mesh = structure.mesh;
  for (const std::array<std::uint32_t, 3>& triangle : {std::array<std::uint32_t, 3>{0, 1, 2},
                                                       {0, 2, 3},
                                                       {2, 1, 0},
                                                       {0, 0, 1},
                                                       {1, 1, 1},
                                                       {0, 2, 2}}) {
    mesh.triangles.push_back(triangle);
    mesh.materials.push_back(0);
  }
  // A sliver whose corners lie in a line.
  mesh.positions.insert(mesh.positions.end(), {{0.1F, 0.1F, 0}, {0.2F, 0.2F, 0}, {0.3F, 0.3F, 0}});
  mesh.triangles.push_back({4, 5, 6});
  mesh.materials.push_back(0);
  const std::vector<Facet> facets = facets_of(mesh);
  REQUIRE(facets.size() == 9);
  for (std::size_t i = 0; i < 8; ++i) {  // the sliver's is what rounding leaves
    INFO("triangle " << i);
    CHECK(facets[i].degenerate() == (i >= 5));
    CHECK(facets[i].normal.length() == Approx(i >= 5 ? 0 : 1));
  }
  expect_flat(structure, 0.7, at(30, 10), at(50, 100));
  expect_flat(structure, 0.7, at(85, 10), at(85, 100));
}

TEST_CASE("a mirror-like GGX, alpha 0.001") {
  // In the mirror direction D = 1 / (pi alpha^2), masking is 1 to 1e-6, and B = D F / (4
  // cos(theta_view)).
  Mesostructure mirror = test::flat(Rgb(1));
  mirror.materials = {Bsdf::conductor_f0(Rgb(1), 0.001F)};
  for (const double theta : {0.0, 30.0, 60.0, 85.0, 89.0}) {
    const double peak = 1 / (std::numbers::pi * 1e-6) / (4 * std::cos(radians(theta)));
    for (const float value : trace(mirror, at(theta, 180), at(theta, 0), settings(4, 4, 4)).values)
      REQUIRE(value == Approx(peak).epsilon(0.02));
    for (const float value :
         trace(mirror, at(theta, 180), at(std::abs(theta - 5), 0), settings(4, 4, 4)).values)
      REQUIRE(value < 1e-4 * peak);
  }
  // Directions drawn from it, at the ends of the random numbers' range: where they are drawn at
  // all, they are unit vectors, and reflections take no more than there is.
  constexpr float last = 0x1.fffffep-1F;
  for (const double theta : {0.0, 1e-3, 45.0, 89.0, 89.9}) {
    for (int i = 0; i <= 256; ++i) {
      for (const float u : {0.0F, 0x1p-24F, last}) {
        for (const float lobe : {0.0F, last}) {
          const float v = std::min(static_cast<float>(i) / 256, last);
          const Bsdf::Sample sample = mirror.materials[0].sample(at(theta, 30), {lobe, u, v});
          INFO("theta " << theta << ", numbers " << lobe << ' ' << u << ' ' << v);
          REQUIRE(sample.pdf >= 0);
          if (sample.pdf == 0) continue;
          REQUIRE(sample.light.length() == Approx(1).epsilon(1e-5));
          REQUIRE(sample.light.z > 0);
          REQUIRE(sample.weight.x >= 0);
          REQUIRE(std::isfinite(sample.weight.x));
          // Over 0.95, the share of that lobe. At grazing views the diffuse part of the tail adds.
          if (lobe == 0 && theta <= 45) REQUIRE(sample.weight.x < 1.06);
        }
      }
    }
  }
  // Bounces drawn from it on a bumpy surface: all are finite.
  Mesostructure bumpy = test::checker(64);
  bumpy.materials.assign(2, Bsdf::conductor_f0(Rgb(0.9F), 0.001F));
  trace(bumpy, at(50, 20), at(40, 100), settings(16, 64, 16));
}

TEST_CASE("albedo 1, with unlimited bounces") {
  expect_flat(test::flat(Rgb(1)), 1, at(40, 10), at(60, 100));
  const Mesostructure white = painted(test::checker(64), 1);
  CHECK(ViewTracer(white, {at(40, 0)}, settings(16, 64, TraceSettings::unlimited))
            .trace(at(50, 90), 1)
            .statistics.trapped == 0);
  agree(white, at(50, 90), at(40, 0), settings(16, 256, TraceSettings::unlimited));
}

TEST_CASE("a deep pit that needs 64 bounces") {
  // A white flask, whose neck is 3 % of its sphere.
  const Cavity flask(0.45, std::acos(0.94), 0.99F);
  flask.agrees(1, 0, 16, 64);
  flask.agrees(64, 0, 12, 64);
  CHECK(flask.expected(64, 0) > 1.9 * flask.expected(16, 0));
}

TEST_CASE("a pit as black as soot, where roulette ends the paths") {
  const Cavity pit(0.45, std::numbers::pi / 2, 0.01F);
  pit.agrees(1, 0, 8, 8);
  pit.agrees(TraceSettings::unlimited, 1, 8, 64);
}

TEST_CASE("a tile of 1e-4 and of 1e4 world units") {
  // A bumpy tile whose corner is far from the origin, as exporters write it.
  const TemporaryFolder folder;
  const auto traced = [&](double unit) {
    constexpr int n = 32;
    std::ofstream obj(folder.path / "bumps.obj");
    obj.precision(9);
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= n; ++j) {
        const auto bump = [](int k) { return std::sin(2 * std::numbers::pi * 2 * k / n); };
        obj << "v " << (3 + j / double{n}) * unit << ' ' << (7 + i / double{n}) * unit << ' '
            << 0.1 * bump(i) * bump(j) * unit << '\n';
      }
    }
    for (int i = 0; i < n; ++i) {
      for (int j = 1; j <= n; ++j) {
        const int a = i * (n + 1) + j;
        obj << "f " << a << ' ' << a + 1 << ' ' << a + n + 2 << ' ' << a + n + 1 << '\n';
      }
    }
    obj.close();
    std::ofstream(folder.path / "bumps.toml")
        << "type = 'mesh'\nfile = 'bumps.obj'\nfit = true\ntile_size = " << unit
        << "\n[materials.default]\ntype = 'lambert'\nalbedo = [0.8, 0.8, 0.8]\n";
    const Mesostructure structure = read_mesostructure(folder.path / "bumps.toml");
    CHECK(structure.tile_size == Approx(unit));
    return trace(structure, at(60, 20), at(70, 100), settings(8, 1024, 4)).values;
  };
  const std::vector<float> expected = traced(1);
  for (const double unit : {1e-4, 1e4}) {
    const std::vector<float> values = traced(unit);
    REQUIRE(values.size() == expected.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      INFO("tile of " << unit << ", value " << i);
      CHECK(values[i] == Approx(expected[i]).epsilon(0.02).margin(1e-4));
    }
  }
}

TEST_CASE("yarns that touch each other and the floor", "[heavy]") {
  // Rings of radius 0.05, 0.1 apart, whose polygons share vertices in the plane of their centres.
  TriangleMesh mesh = test::flat(Rgb(1)).mesh;
  for (const double major : {0.1, 0.2, 0.3, 0.4}) test::add_torus(mesh, major, 0.05, 128, 32);
  for (std::size_t i = 4; i < mesh.positions.size(); ++i) mesh.positions[i].z += 0.02F;
  mesh.material_names = {"base", "ring"};
  const Mesostructure rings = test::structure(
      mesh, {Bsdf::lambert({0.1F, 0.3F, 0.6F}), Bsdf::lambert({0.9F, 0.7F, 0.2F})}, 0.1F);
  agree(rings, at(50, 20), at(40, 100), settings(16, 256, 8));
  agree(rings, at(80, 20), at(70, 100), settings(16, 256, 8));
  agree_directly(rings, {0.3, 0.7}, at(80, 20), at(70, 100));
}

TEST_CASE("millions of triangles", "[heavy]") {
  const Mesostructure fine = test::checker(1024);
  REQUIRE(fine.mesh.triangles.size() > 2'000'000);
  TraceSettings s = settings(32, 64, 4);
  s.views = 1;  // without a table, which would take most of the time
  agree(fine, at(50, 20), at(40, 100), s);
}
