// Gravel: stones are closed bodies of the form asked for, rest on something, and do not reach into
// each other.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numeric>

#include "acquisition/mesostructure.h"
#include "acquisition/mesostructures/stone.h"
#include "acquisition/mesostructures/stone_bed.h"
#include "btf/error.h"
#include "tests/acquisition/material_layers.h"
#include "tests/acquisition/mesostructure_files.h"

using namespace weft;
using Catch::Matchers::Contains;

namespace {

/// Each connected part of the mesh as a material of its own.
TriangleMesh parts_as_materials(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> root(mesh.positions.size());
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    root[find(b)] = find(a);
    root[find(c)] = find(a);
  }
  TriangleMesh result = mesh;
  result.material_names.clear();
  std::map<std::uint32_t, std::uint16_t> parts;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto fresh = static_cast<std::uint16_t>(parts.size());
    const auto [found, added] = parts.try_emplace(find(mesh.triangles[t][0]), fresh);
    if (added) result.material_names.push_back(std::to_string(fresh));
    result.materials[t] = found->second;
  }
  return result;
}

double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Imath::V3d p(mesh.positions[a]);
    sum += p.dot(Imath::V3d(mesh.positions[b]).cross(Imath::V3d(mesh.positions[c]))) / 6;
  }
  return sum;
}

}  // namespace

TEST_CASE("a stone is a closed body that faces outwards, flatter and smaller as asked") {
  const StoneForm form{.radius = 0.1, .flatness = 0, .roundness = 0.4, .bumps = 0.05};
  const auto volume_of = [](const StoneForm& f) { return volume(make_stone(f, 3, 4)); };
  const double ball = 4.0 / 3 * 3.14159265 * 1e-3;
  CHECK(volume_of(form) > 0.3 * ball);
  CHECK(volume_of(form) < 1.1 * ball);
  StoneForm half = form;
  half.radius = 0.05;
  CHECK(volume_of(half) == Approx(volume_of(form) / 8).epsilon(1e-5));
  StoneForm flat = form;
  flat.flatness = 0.5;
  CHECK(volume_of(flat) < 0.5 * volume_of(form));
  CHECK(volume_of(flat) > 0.25 * volume_of(form));
  CHECK(make_stone(form, 2, 4).triangles.size() == 320);
  CHECK(make_stone(form, 2, 4).positions != make_stone(form, 2, 5).positions);
}

TEST_CASE("a stone becomes more angular with less roundness") {
  // A sharp body has flat faces and sharp edges: many neighbours almost in one plane, few at large
  // angles.
  const auto flat_part = [](double roundness) {
    const TriangleMesh mesh = make_stone({0.1, 0, roundness, 0}, 4, 7);
    std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> sides;
    int flat = 0;
    int edges = 0;
    for (const auto& t : mesh.triangles) {
      const Vec3& p = mesh.positions[t[0]];
      const Vec3 normal = (mesh.positions[t[1]] - p).cross(mesh.positions[t[2]] - p).normalized();
      for (int k = 0; k < 3; ++k) {
        const auto [found, added] = sides.try_emplace(std::minmax(t[k], t[(k + 1) % 3]), normal);
        if (added) continue;
        ++edges;
        flat += found->second.dot(normal) > 0.9998F;
      }
    }
    return static_cast<double>(flat) / edges;
  };
  CHECK(flat_part(0.1) > 0.5);
  CHECK(flat_part(0.3) < flat_part(0.1));
  CHECK(flat_part(1) < flat_part(0.3));
}

TEST_CASE("bodies come to rest on the floor, on each other, and across the border of the tile") {
  StoneBed bed(100);
  const TriangleMesh ball = make_stone({0.2, 0, 1, 0}, 4, 1);
  const StoneBed::Footprint footprint = bed.footprint(ball);
  float lowest = 0;
  float highest = 0;
  for (const Vec3& p : ball.positions) {
    lowest = std::min(lowest, p.z);
    highest = std::max(highest, p.z);
  }
  CHECK(bed.rest(footprint, 95, 3) == Approx(-lowest).margin(1e-3));
  bed.lay(footprint, 95, 3, -lowest);
  CHECK(bed.rest(footprint, 50, 50) == Approx(-lowest).margin(1e-3));
  // Straight above it: at least its height minus what its underside fits into its top.
  CHECK(bed.rest(footprint, 95, 3) > highest - 2 * lowest - 0.1F);
  // It sticks out over both borders.
  CHECK(bed.rest(footprint, 5, 95) > -lowest + 0.05F);
}

TEST_CASE("stones of gravel rest on something and do not reach into each other") {
  constexpr int stones = 60;
  const Mesostructure m = read_mesostructure(mesostructure_folder() / "gravel.toml", {"stones=60"});
  const TriangleMesh mesh = parts_as_materials(m.mesh);
  REQUIRE(mesh.material_names.size() == stones + 1);
  std::vector<MaterialLayers> layers;
  for (const std::string& part : mesh.material_names) layers.emplace_back(mesh, part);
  std::vector<float> least_gap(stones + 1, 1);
  double shared = 0;
  double all = 0;
  for (int cell = 0; cell < MaterialLayers::size * MaterialLayers::size; ++cell) {
    std::vector<std::pair<MaterialLayers::Range, int>> here;
    for (int part = 0; part <= stones; ++part) {
      const auto& range = layers[part].at(cell % MaterialLayers::size, cell / MaterialLayers::size);
      if (range.empty()) continue;
      here.emplace_back(range, part);
      all += range.upper - range.lower;
    }
    std::sort(here.begin(), here.end(),
              [](const auto& a, const auto& b) { return a.first.lower < b.first.lower; });
    for (std::size_t k = 1; k < here.size(); ++k) {
      const float gap = here[k].first.lower - here[k - 1].first.upper;
      least_gap[here[k].second] = std::min(least_gap[here[k].second], gap);
      shared += std::max(0.0F, -gap);
    }
  }
  CHECK(shared < 1e-3 * all);
  for (int stone = 0; stone < stones; ++stone) CHECK(least_gap[stone] < 0.005F);
}

TEST_CASE("gravel hides nearly all of the floor") {
  const TriangleMesh mesh =
      read_mesostructure(mesostructure_folder() / "gravel.toml", {"subdivide=2"}).mesh;
  const MaterialLayers layers[] = {MaterialLayers(mesh, "stone"),
                                   MaterialLayers(mesh, "pale_stone"),
                                   MaterialLayers(mesh, "dark_stone")};
  int bare = 0;
  for (int cell = 0; cell < MaterialLayers::size * MaterialLayers::size; ++cell) {
    bare += std::ranges::all_of(layers, [&](const MaterialLayers& l) {
      return l.at(cell % MaterialLayers::size, cell / MaterialLayers::size).empty();
    });
  }
  CHECK(bare < MaterialLayers::size * MaterialLayers::size / 8);
}

TEST_CASE("gravel's sizes are those asked for, and the largest is not below the smallest") {
  const auto file = mesostructure_folder() / "gravel.toml";
  const TriangleMesh mesh = parts_as_materials(
      read_mesostructure(file, {"stones=20", "largest=0.1", "smallest=0.02"}).mesh);
  std::vector<float> widths(mesh.material_names.size());
  std::vector<Vec3> begins(widths.size(), Vec3(-10));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3& p = mesh.positions[mesh.triangles[t][0]];
    Vec3& begin = begins[mesh.materials[t]];
    if (begin.x < -9) begin = p;
    widths[mesh.materials[t]] = std::max(widths[mesh.materials[t]], (p - begin).length());
  }
  REQUIRE(widths.size() == 21);
  CHECK(widths.front() == Approx(0.17).margin(0.05));
  CHECK(widths[19] == Approx(0.034).margin(0.01));
  CHECK_THROWS_WITH(read_mesostructure(file, {"smallest=0.2"}),
                    Contains("--set smallest=0.2") && Contains("'smallest' is 0.2, expected"));
}
