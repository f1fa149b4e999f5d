// Woven cloth: yarns lie over and under as the pattern says, never meet, and answer to their keys.
#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "acquisition/mesostructure.h"
#include "btf/error.h"
#include "tests/acquisition/material_layers.h"
#include "tests/acquisition/mesostructure_files.h"

using namespace weft;
using Catch::Matchers::Contains;

namespace {

Mesostructure read_weave(const std::string& text, std::vector<std::string> overrides = {}) {
  const TemporaryFolder folder;
  return read_mesostructure(write_file(folder, "a.toml", "type = 'weave'\nsmooth = true\n" + text),
                            overrides);
}

std::string refusal(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    read_weave(text, overrides);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// Width, height of the box around the yarn of a material that crosses the middle of the tile.
Vec3 extent(const TriangleMesh& mesh, const std::string& material) {
  Vec3 lower(10);
  Vec3 upper(-10);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.material_names[mesh.materials[t]] != material) continue;
    for (const std::uint32_t vertex : mesh.triangles[t]) {
      for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], mesh.positions[vertex][axis]);
        upper[axis] = std::max(upper[axis], mesh.positions[vertex][axis]);
      }
    }
  }
  return upper - lower;
}

}  // namespace

TEST_CASE("warp and weft lie at every crossing as the pattern says, its first row on top") {
  const std::vector<std::string> rows = {"110", "101", "011", "010"};
  const Mesostructure m = read_weave("pattern = '110/101/011/010'\nrepeat = [2, 1]\n");
  const MaterialLayers weft(m.mesh, "weft");
  const MaterialLayers warp(m.mesh, "warp");
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 6; ++column) {
      INFO("row " << row << ", column " << column);
      const int x = (2 * column + 1) * MaterialLayers::size / 12;
      const int y = (7 - 2 * row) * MaterialLayers::size / 8;
      const bool warp_over = rows[row][column % 3] == '1';
      const auto& over = (warp_over ? warp : weft).at(x, y);
      const auto& under = (warp_over ? weft : warp).at(x, y);
      REQUIRE_FALSE(over.empty());
      REQUIRE_FALSE(under.empty());
      CHECK(over.lower > under.upper);
    }
  }
}

TEST_CASE("yarns of any pattern and form never pass through each other, nor the floor") {
  for (const char* text :
       {"", "pattern = '1110/1101/1011/0111'\nbow = 0\n",
        "pattern = '01111/11011/11110/10111/11101'\nyarn.flattening = 0\n",
        "repeat = [1, 3]\nyarn.radius = 0.07\nwarp = { radius = 0.2, flattening = "
        "0.8, plies = 3, twist = 2 }\n",
        "repeat = [3, 3]\nyarn.radius = 0.0799\ngap = 0.02\n"}) {
    INFO(text);
    const Mesostructure m = read_weave(text, {"subdivide=2"});
    const MaterialLayers weft(m.mesh, "weft");
    const MaterialLayers warp(m.mesh, "warp");
    int both = 0;
    int mixed = 0;
    float lowest = 1;
    for (int y = 0; y < MaterialLayers::size; ++y) {
      for (int x = 0; x < MaterialLayers::size; ++x) {
        const auto& a = weft.at(x, y);
        const auto& b = warp.at(x, y);
        lowest = std::min({lowest, a.lower, b.lower});
        if (a.empty() || b.empty()) continue;
        ++both;
        mixed += a.lower < b.upper && b.lower < a.upper;
      }
    }
    CHECK(both > MaterialLayers::size * MaterialLayers::size / 5);
    CHECK(mixed == 0);
    CHECK(lowest > 0);
  }
}

TEST_CASE("a yarn has the radius and flattening that are asked for, of its family or of both") {
  // One warp a tile crosses one weft twice: the pattern's 2 x 1 would not be woven in.
  const std::string plain =
      "pattern = '10/01'\nrepeat = [1, 1]\n[yarn]\nradius = 0.1\nflattening = 0\n";
  const auto widths = [&](const std::vector<std::string>& overrides) {
    const TriangleMesh mesh = read_weave(plain, overrides).mesh;
    // Two yarns with centre lines 0.5 apart.
    return Vec2(extent(mesh, "weft").y - 0.5F, extent(mesh, "warp").x - 0.5F);
  };
  CHECK(widths({}).x == Approx(0.2).epsilon(0.01));
  CHECK(widths({}).y == Approx(0.2).epsilon(0.01));
  CHECK(widths({"yarn.radius=0.04"}).x == Approx(0.08).epsilon(0.01));
  CHECK(widths({"warp.radius=0.05"}).x == Approx(0.2).epsilon(0.01));
  CHECK(widths({"warp.radius=0.05"}).y == Approx(0.1).epsilon(0.01));
  // Each family goes up and down by the other's thickness and the gap, and is as thick as it is.
  const TriangleMesh mesh = read_weave(plain, {"warp.flattening=0.5", "gap=0.1"}).mesh;
  CHECK(extent(mesh, "weft").z == Approx(2 * (0.05 * 1.1 + 0.1)).epsilon(0.01));
  CHECK(extent(mesh, "warp").z == Approx(2 * (0.1 * 1.1 + 0.05)).epsilon(0.01));
}

TEST_CASE("the middle of a float is bowed, and a plain weave has no floats") {
  const auto top = [](const std::string& text) { return extent(read_weave(text).mesh, "warp").z; };
  const std::string twill = "pattern = '1110/1101/1011/0111'\n";
  const float half_thickness = 0.46F / 8 / 2;
  CHECK(top(twill + "bow = 0.4\n") - top(twill + "bow = 0\n") ==
        Approx(0.4 * half_thickness).epsilon(0.02));
  CHECK(top("bow = 1\n") == Approx(top("bow = 0\n")));
}

TEST_CASE(
    "a pattern that is no cloth is refused, and so is a yarn that its neighbours leave no room") {
  CHECK_THAT(refusal("pattern = '10/0'\n"), Contains("a.toml:3:1") && Contains("'pattern'") &&
                                                Contains("row 2 has 1 crossings, and row 1 has 2"));
  CHECK_THAT(refusal("pattern = '10/0x'\n"), Contains("row 2 is '0x', expected 0 and 1"));
  CHECK_THAT(refusal("pattern = '11/01'\n"), Contains("the weft of row 1 is not woven in"));
  CHECK_THAT(refusal("pattern = '10/10'\n"), Contains("the warp of column 1 is not woven in"));
  CHECK_THAT(refusal("pattern = ''\n"), Contains("row 1 is not woven in"));
  CHECK_THAT(refusal("repeat = [40, 1]\n"), Contains("80 warps and 2 wefts"));
  CHECK_THAT(refusal("repeat = [1.5, 1]\n"), Contains("'repeat' is [1.5, 1]"));
  CHECK_THAT(refusal("", {"yarn.radius=0.2"}),
             Contains("--set yarn.radius=0.2") && Contains("'yarn.radius' is 0.2, expected"));
  CHECK_THAT(refusal("", {"warp.radus=0.1"}), Contains("did you mean 'warp.radius'"));
}
