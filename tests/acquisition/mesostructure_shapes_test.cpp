// The shapes of the mesostructures: reference definitions, no border, sound normals, yarns that go
// over and under.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "acquisition/mesostructure.h"
#include "images/image_file.h"
#include "tests/acquisition/material_layers.h"
#include "tests/acquisition/mesostructure_files.h"

using namespace weft;

namespace {

using Vec3d = Imath::V3d;

Mesostructure read(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return read_mesostructure(mesostructure_folder() / (name + ".toml"), overrides);
}

/// A height field of an uneven pattern, subdivided or not.
Mesostructure read_bumps(const TemporaryFolder& folder, int levels) {
  Image image(12, 9, 3);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 12; ++x)
      image.set_rgb(x, y, Rgb(static_cast<float>((x * 7 + y * 5) % 11) / 11));
  }
  write_image(folder.path / "bumps.exr", image, Encoding::linear);
  return read_mesostructure(
      write_file(folder, "bumps.toml", "type = 'heightfield'\nfile = 'bumps.exr'\nsmooth = true\n"),
      {"subdivide=" + std::to_string(levels)});
}

/// Every smooth one of the project's files, and height fields.
std::vector<Mesostructure> all_mesostructures(const TemporaryFolder& folder) {
  std::vector<Mesostructure> all;
  for (const std::string& name : mesostructure_names()) {
    Mesostructure m = read(name);
    if (!m.mesh.normals.empty()) all.push_back(std::move(m));
  }
  all.push_back(read_bumps(folder, 0));
  all.push_back(read_bumps(folder, 2));
  return all;
}

/// A position modulo the tile, on a grid that is coarser than rounding and finer than the meshes.
std::array<std::int64_t, 3> place(const Vec3& p) {
  constexpr double grid = 20000;
  constexpr auto size = static_cast<std::int64_t>(grid);
  const auto wrapped = [&](double v) { return (std::llround(v * grid) % size + size) % size; };
  return {wrapped(p.x), wrapped(p.y), std::llround(p.z * grid)};
}

Vec3d facet_normal(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Vec3d p(mesh.positions[t[0]]);
  return (Vec3d(mesh.positions[t[1]]) - p).cross(Vec3d(mesh.positions[t[2]]) - p);
}

}  // namespace

TEST_CASE("no mesostructure has a border: every edge meets another, across the tile too") {
  const TemporaryFolder folder;
  for (const Mesostructure& m : all_mesostructures(folder)) {
    INFO(m.type << " with " << m.mesh.triangles.size() << " triangles");
    std::map<std::array<std::array<std::int64_t, 3>, 2>, int> edges;
    for (const auto& t : m.mesh.triangles) {
      for (int k = 0; k < 3; ++k) {
        const auto a = place(m.mesh.positions[t[k]]);
        const auto b = place(m.mesh.positions[t[(k + 1) % 3]]);
        if (a < b) ++edges[{a, b}];
        if (b < a) --edges[{b, a}];
      }
    }
    const auto open =
        std::count_if(edges.begin(), edges.end(), [](const auto& e) { return e.second != 0; });
    CHECK(open == 0);
  }
}

TEST_CASE("vertices that are one across the border have one normal") {
  const TemporaryFolder folder;
  for (const Mesostructure& m : all_mesostructures(folder)) {
    INFO(m.type);
    std::map<std::pair<std::array<std::int64_t, 3>, std::uint16_t>, Vec3> normals;
    int shared = 0;
    float worst = 0;
    for (std::size_t t = 0; t < m.mesh.triangles.size(); ++t) {
      for (const std::uint32_t vertex : m.mesh.triangles[t]) {
        const auto key = std::pair{place(m.mesh.positions[vertex]),
                                   m.type == "checker" ? std::uint16_t{0} : m.mesh.materials[t]};
        const auto [found, added] = normals.try_emplace(key, m.mesh.normals[vertex]);
        if (added) continue;
        ++shared;
        worst = std::max(worst, (found->second - m.mesh.normals[vertex]).length());
      }
    }
    CHECK(shared > 0);
    CHECK(worst < 2e-4F);
  }
}

TEST_CASE("normals are unit vectors on the outer side of their facets") {
  const TemporaryFolder folder;
  for (const Mesostructure& m : all_mesostructures(folder)) {
    INFO(m.settings);
    double longest = 0;
    double least_cosine = 1;
    double mean_cosine = 0;
    for (const Vec3& n : m.mesh.normals) longest = std::max(longest, std::abs(n.length() - 1.0));
    for (const auto& t : m.mesh.triangles) {
      const Vec3d normal = facet_normal(m.mesh, t).normalized();
      for (const std::uint32_t vertex : t) {
        const double cosine = normal.dot(Vec3d(m.mesh.normals[vertex]));
        least_cosine = std::min(least_cosine, cosine);
        mean_cosine += cosine / (3.0 * static_cast<double>(m.mesh.triangles.size()));
      }
    }
    CHECK(longest < 1e-5);
    CHECK(least_cosine > 0.5);
    CHECK(mean_cosine > 0.8);  // the coarse height field's; the smooth ones are above 0.99
  }
}

TEST_CASE("the checker is the mesh that the reference pictures were made of") {
  const Mesostructure m = read("checker", {"smooth=false"});
  CHECK(m.mesh.normals.empty());
  CHECK(m.reference_height == Approx(0.15).margin(0.001));
  REQUIRE(m.mesh.triangles.size() == 2 * 256 * 256);
  const auto height = [](double x, double y) {
    const double s = std::sin(2 * std::numbers::pi * x) * std::sin(2 * std::numbers::pi * y);
    return 0.15 / 2 * (1 + s / std::sqrt(s * s + 0.02));
  };
  double worst = 0;
  for (const Vec3& p : m.mesh.positions) worst = std::max(worst, std::abs(p.z - height(p.x, p.y)));
  CHECK(worst < 2e-6);
  std::map<std::uint16_t, int> counts;
  int wrong = 0;
  for (std::size_t i = 0; i < m.mesh.triangles.size(); ++i) {
    const auto& t = m.mesh.triangles[i];
    const Vec3 middle =
        (m.mesh.positions[t[0]] + m.mesh.positions[t[1]] + m.mesh.positions[t[2]]) / 3.0F;
    const bool raised = (middle.x < 0.5F) == (middle.y < 0.5F);
    wrong += m.mesh.material_names[m.mesh.materials[i]] != (raised ? "raised" : "low");
    ++counts[m.mesh.materials[i]];
    // The diagonal goes from (x min, y min) to (x max, y max).
    const Vec3& first = m.mesh.positions[t[0]];
    const Vec3& far = m.mesh.positions[t[i % 2 == 0 ? 2 : 1]];
    wrong += std::abs(far.x - first.x - 1.0F / 256) > 1e-6F ||
             std::abs(far.y - first.y - 1.0F / 256) > 1e-6F;
  }
  CHECK(wrong == 0);
  CHECK(counts[0] == counts[1]);
}

TEST_CASE("checker normals are those of its formula") {
  const Mesostructure m = read("checker");
  const auto height = [](double x, double y) {
    const double s = std::sin(2 * std::numbers::pi * x) * std::sin(2 * std::numbers::pi * y);
    return 0.15 / 2 * (1 + s / std::sqrt(s * s + 0.02));
  };
  double worst = 0;
  for (std::size_t i = 0; i < m.mesh.positions.size(); ++i) {
    const Vec3d p(m.mesh.positions[i]);
    const double d = 1e-5;
    const Vec3d normal = Vec3d((height(p.x - d, p.y) - height(p.x + d, p.y)) / (2 * d),
                               (height(p.x, p.y - d) - height(p.x, p.y + d)) / (2 * d), 1)
                             .normalized();
    worst = std::max(worst, (normal - Vec3d(m.mesh.normals[i])).length());
  }
  CHECK(worst < 1e-4);
}

TEST_CASE("the rings are tori on a plane, as in the reference") {
  const Mesostructure m = read("rings", {"smooth=false", "segments=1024", "minor_segments=128"});
  CHECK(m.reference_height == 0.06F);
  REQUIRE(m.mesh.triangles.size() == 2 + 4 * 2 * 1024 * 128);
  double worst = 0;
  std::set<int> majors;
  for (std::size_t t = 0; t < m.mesh.triangles.size(); ++t) {
    const bool base = m.mesh.material_names[m.mesh.materials[t]] == "base";
    for (const std::uint32_t vertex : m.mesh.triangles[t]) {
      const Vec3d p(m.mesh.positions[vertex]);
      if (base) {
        worst = std::max(worst, std::abs(p.z));
        continue;
      }
      const double radius = std::hypot(p.x - 0.5, p.y - 0.5);
      const auto tenths = static_cast<int>(std::lround(radius * 10));
      majors.insert(tenths);
      worst = std::max(worst, std::abs(std::hypot(radius - tenths / 10.0, p.z - 0.03) - 0.03));
    }
  }
  CHECK(worst < 1e-6);
  CHECK(majors == std::set<int>{1, 2, 3, 4});
}

TEST_CASE("ring normals are those of tori") {
  const Mesostructure m = read("rings");
  double worst = 0;
  for (std::size_t i = 4; i < m.mesh.positions.size(); ++i) {
    const Vec3d p(m.mesh.positions[i]);
    const double radius = std::hypot(p.x - 0.5, p.y - 0.5);
    const double major = std::round(radius * 10) / 10;
    const Vec3d ring(0.5 + (p.x - 0.5) * major / radius, 0.5 + (p.y - 0.5) * major / radius, 0.03);
    worst = std::max(worst, ((p - ring).normalized() - Vec3d(m.mesh.normals[i])).length());
  }
  CHECK(worst < 2e-5);
}

TEST_CASE("yarns go over and under in turn, and nearly touch") {
  const Mesostructure m = read("tissue", {"plies=0"});
  const MaterialLayers weft(m.mesh, "weft");
  const MaterialLayers warp(m.mesh, "warp");
  const float thickness = 0.3F / 4;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      const int x = (2 * i + 1) * MaterialLayers::size / 8;
      const int y = (2 * j + 1) * MaterialLayers::size / 8;
      const bool weft_over = (i + j) % 2 == 0;
      const MaterialLayers::Range& over = (weft_over ? weft : warp).at(x, y);
      const MaterialLayers::Range& under = (weft_over ? warp : weft).at(x, y);
      CHECK(over.lower > under.upper);
      CHECK(over.lower - under.upper < 0.1F * thickness);
      CHECK(over.upper - over.lower == Approx(thickness).epsilon(0.02));
    }
  }
}

TEST_CASE("yarns do not pass through each other, nor through the floor") {
  for (const char* plies : {"plies=0", "plies=3"}) {
    INFO(plies);
    const Mesostructure m = read("tissue", {plies});
    const MaterialLayers weft(m.mesh, "weft");
    const MaterialLayers warp(m.mesh, "warp");
    int both = 0;
    int mixed = 0;
    float lowest = 1;
    for (int y = 0; y < MaterialLayers::size; ++y) {
      for (int x = 0; x < MaterialLayers::size; ++x) {
        const MaterialLayers::Range& a = weft.at(x, y);
        const MaterialLayers::Range& b = warp.at(x, y);
        lowest = std::min({lowest, a.lower, b.lower});
        if (a.empty() || b.empty()) continue;
        ++both;
        mixed += a.lower < b.upper && b.lower < a.upper;
      }
    }
    CHECK(both > MaterialLayers::size * MaterialLayers::size / 3);
    CHECK(mixed == 0);
    CHECK(lowest > 0);
  }
}

TEST_CASE(
    "the weave's triangle count is moderate, and its limit normals are those of finer meshes") {
  const Mesostructure coarse = read("tissue");
  CHECK(coarse.mesh.triangles.size() > 50'000);
  CHECK(coarse.mesh.triangles.size() < 200'000);
  // Facets approach the limit surface, and so its normals, as their size: a quarter after two
  // levels.
  const auto deviation = [](const TriangleMesh& mesh) {
    double squares = 0;
    for (const auto& triangle : mesh.triangles) {
      Vec3d shading(0);
      for (const std::uint32_t vertex : triangle) shading += Vec3d(mesh.normals[vertex]);
      squares += (shading.normalized() - facet_normal(mesh, triangle).normalized()).length2();
    }
    return std::sqrt(squares / static_cast<double>(mesh.triangles.size()));
  };
  const Mesostructure fine = read("tissue", {"subdivide=3"});
  CHECK(deviation(coarse.mesh) < 0.1);
  CHECK(deviation(fine.mesh) < 0.3 * deviation(coarse.mesh));
}
