// Structures, directions and materials at the edge of what floats can bear: finite, non-negative,
// and what a formula or the plain tracer answers.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <numbers>

#include "acquisition/mesostructure.h"
#include "acquisition/naive_tracer.h"
#include "acquisition/view_tracer.h"
#include "tests/acquisition/known_structures.h"
#include "tests/temporary_folder.h"

using namespace weft;

namespace {

Direction at(double theta, double phi) {
  return from_spherical(radians(theta), radians(phi));
}

TraceSettings settings(int size, int spp, int max_bounces) {
  return {.width = size,
          .height = size,
          .spp = spp,
          .max_bounces = max_bounces,
          .texel_errors = true,
          .seed = 11};
}

TracedView trace(const Mesostructure& structure, const Direction& view, const Direction& light,
                 const TraceSettings& s) {
  const TracedView traced = ViewTracer(structure, {light}, s).trace(view, 1);
  for (const float value : traced.values) {
    REQUIRE(std::isfinite(value));
    REQUIRE(value >= 0);
  }
  CHECK(traced.statistics.invalid == 0);
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

}  // namespace

TEST_CASE("theta of 89 degrees, of light and of view") {
  expect_flat(test::flat(Rgb(0.5F)), 0.5, at(89, 10), at(89, 200));
  agree(test::checker(64), at(89, 30), at(40, 100), settings(16, 256, 4));
  agree(test::checker(64), at(40, 100), at(89, 30), settings(32, 1024, 4));
  agree(test::checker(64), at(89, 30), at(89, 75), settings(16, 1024, 4));
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
  expect_flat(structure, 0.7, at(30, 10), at(50, 100));
  expect_flat(structure, 0.7, at(85, 10), at(85, 100));
}

TEST_CASE("a mirror-like GGX, alpha 0.001") {
  // In the mirror direction D = 1 / (pi alpha^2), masking is 1 to 1e-6, and B = D F / (4
  // cos(theta_view)).
  Mesostructure mirror = test::flat(Rgb(1));
  mirror.materials = {Bsdf::conductor_f0(Rgb(1), 0.001F)};
  for (const double theta : {0.0, 30.0, 60.0}) {
    const double peak = 1 / (std::numbers::pi * 1e-6) / (4 * std::cos(radians(theta)));
    for (const float value : trace(mirror, at(theta, 180), at(theta, 0), settings(4, 4, 4)).values)
      REQUIRE(value == Approx(peak).epsilon(0.02));
    for (const float value :
         trace(mirror, at(theta, 180), at(theta + 5, 0), settings(4, 4, 4)).values)
      REQUIRE(value < 1e-4 * peak);
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
  // A shaft 0.8 tiles wide and 6.4 deep below a rim, white as snow.
  TriangleMesh mesh;
  const auto quad = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
    mesh.materials.insert(mesh.materials.end(), {0, 0});
  };
  const std::array<Vec3, 4> top = {
      Vec3(0.1F, 0.1F, 0), {0.9F, 0.1F, 0}, {0.9F, 0.9F, 0}, {0.1F, 0.9F, 0}};
  const std::array<Vec3, 4> rim = {Vec3(0, 0, 0), {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const Vec3 down(0, 0, -6.4F);
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t j = (i + 1) % 4;
    quad(rim[i], rim[j], top[j], top[i]);
    quad(top[j], top[i], top[i] + down, top[j] + down);
  }
  quad(top[0] + down, top[1] + down, top[2] + down, top[3] + down);
  mesh.material_names = {"default"};
  const Mesostructure shaft = test::structure(mesh, {Bsdf::lambert(Rgb(0.99F))}, 0);
  const double with_64 = agree(shaft, at(5, 20), at(60, 0), settings(8, 512, 64));
  const double with_8 = agree(shaft, at(5, 20), at(60, 0), settings(8, 512, 8));
  CHECK(with_64 > 1.05 * with_8);
}

TEST_CASE("a tile of 1e-4 and of 1e4 world units") {
  const TemporaryFolder folder;
  const auto values = [&](const std::string& tile_size) {
    std::ofstream(folder.path / "a.toml")
        << "type = 'checker'\nresolution = 32\ntile_size = " << tile_size << "\n";
    const Mesostructure structure = read_mesostructure(folder.path / "a.toml");
    CHECK(structure.tile_size == std::stof(tile_size));
    return trace(structure, at(50, 20), at(40, 100), settings(8, 16, 4)).values;
  };
  const auto expected = values("1.0");
  CHECK(values("1e-4") == expected);
  CHECK(values("1e4") == expected);
}

TEST_CASE("yarns that touch each other and the floor") {
  // Rings of radius 0.05, 0.1 apart, whose polygons share vertices in the plane of their centres.
  TriangleMesh mesh = test::flat(Rgb(1)).mesh;
  for (const double major : {0.1, 0.2, 0.3, 0.4}) test::add_torus(mesh, major, 0.05, 128, 32);
  for (std::size_t i = 4; i < mesh.positions.size(); ++i) mesh.positions[i].z += 0.02F;
  mesh.material_names = {"base", "ring"};
  const Mesostructure rings = test::structure(
      mesh, {Bsdf::lambert({0.1F, 0.3F, 0.6F}), Bsdf::lambert({0.9F, 0.7F, 0.2F})}, 0.1F);
  agree(rings, at(50, 20), at(40, 100), settings(16, 256, 8));
  agree(rings, at(80, 20), at(70, 100), settings(16, 256, 8));
}

TEST_CASE("a million triangles", "[heavy]") {
  const Mesostructure fine = test::checker(720);
  REQUIRE(fine.mesh.triangles.size() > 1'000'000);
  agree(fine, at(50, 20), at(40, 100), settings(32, 64, 4));
}
