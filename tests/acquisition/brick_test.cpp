// Brick walls: rounded blocks, running bond, mortar set back, bricks that keep apart.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <set>

#include "acquisition/mesostructure.h"
#include "acquisition/mesostructures/block.h"
#include "btf/error.h"
#include "tests/acquisition/material_layers.h"
#include "tests/acquisition/mesostructure_files.h"

using namespace weft;
using Catch::Matchers::Contains;

namespace {

Mesostructure read_wall(const std::vector<std::string>& overrides) {
  return read_mesostructure(mesostructure_folder() / "brick_wall.toml", overrides);
}

/// Height of the wall above a place, and what is there.
struct Surface {
  float height = -1;
  std::string material;
};
Surface surface_at(const Mesostructure& wall, double x, double y) {
  Surface result;
  for (const std::string& name : wall.mesh.material_names) {
    const MaterialLayers layers(wall.mesh, name);
    const auto& range = layers.at(static_cast<int>(x * MaterialLayers::size),
                                  static_cast<int>(y * MaterialLayers::size));
    if (!range.empty() && range.upper > result.height) result = {range.upper, name};
  }
  return result;
}

}  // namespace

TEST_CASE("a block is a box with its edges rounded") {
  const BlockForm form{
      .width = 0.5, .height = 0.2, .depth = 0.3, .rounding = 0.04, .spacing = 0.02};
  const TriangleMesh mesh = make_block(form);
  Vec3 lower(1);
  Vec3 upper(-1);
  double volume = 0;
  double worst = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3& p = mesh.positions[i];
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], p[axis]);
      upper[axis] = std::max(upper[axis], p[axis]);
    }
    // Every point is one radius away, along its normal, from the box that is smaller by it.
    const Vec3 core = p - mesh.normals[i] * 0.04F;
    worst = std::max(
        {worst, std::abs(core.x) - 0.21, std::abs(core.y) - 0.06, std::abs(core.z + 0.15) - 0.11});
  }
  for (const auto& [a, b, c] : mesh.triangles)
    volume += mesh.positions[a].dot(mesh.positions[b].cross(mesh.positions[c])) / 6;
  CHECK((lower - Vec3(-0.25F, -0.1F, -0.3F)).length() < 1e-6F);
  CHECK((upper - Vec3(0.25F, 0.1F, 0)).length() < 1e-6F);
  CHECK(worst < 1e-6);
  // Steiner's formula for the box within and a ball.
  const double a = 0.42;
  const double b = 0.12;
  const double c = 0.22;
  const double r = 0.04;
  const double steiner = a * b * c + 2 * r * (a * b + b * c + c * a) +
                         std::numbers::pi * r * r * (a + b + c) +
                         4.0 / 3 * std::numbers::pi * r * r * r;
  CHECK(volume == Approx(steiner).epsilon(0.01));
}

TEST_CASE("an even wall has its bricks in running bond, and its mortar at height 0") {
  const Mesostructure wall =
      read_wall({"variation=0", "roughness=0", "joint=0.2", "recess=0.3", "courses=4"});
  for (int course = 0; course < 4; ++course) {
    INFO("course " << course);
    const double y = (course + 0.5) / 4;
    const double moved = course % 2 == 0 ? 0 : 0.25;
    for (const double x : {0.25, 0.75}) {
      const Surface brick = surface_at(wall, std::fmod(x + moved, 1), y);
      CHECK(brick.height == Approx(0.3 / 4));
      CHECK_THAT(brick.material, Contains("brick"));
      const Surface joint = surface_at(wall, std::fmod(x + moved + 0.25, 1), y);
      CHECK(joint.height == Approx(0).margin(1e-6));
      CHECK(joint.material == "mortar");
    }
    CHECK(surface_at(wall, 0.3, course / 4.0).material == "mortar");
    // 0.05 of a tile is the joint: its border is half of that away from its middle.
    CHECK(surface_at(wall, 0.25 + moved, y - 0.125 + 0.035).material != "mortar");
    CHECK(surface_at(wall, 0.25 + moved, y - 0.125 + 0.015).material == "mortar");
  }
}

TEST_CASE("bricks differ in tone, height and tilt, and so does every seed") {
  const auto tops = [](const std::string& seed) {
    const Mesostructure wall = read_wall({"roughness=0", "seed=" + seed});
    std::set<std::string> tones;
    std::vector<float> heights;
    for (int course = 0; course < 6; ++course) {
      const Surface s = surface_at(wall, 0.4, (course + 0.5) / 6);
      tones.insert(s.material);
      heights.push_back(s.height);
    }
    CHECK(tones.size() > 1);
    for (std::size_t k = 1; k < heights.size(); ++k) CHECK(heights[k] != heights[0]);
    return heights;
  };
  CHECK(tops("3") == tops("3"));
  CHECK(tops("3") != tops("4"));
}

TEST_CASE("bricks do not touch each other at the largest tilt") {
  // What looks up in the joints' middles is mortar, all along.
  const Mesostructure wall = read_wall({"tilt=5"});
  const MaterialLayers mortar(wall.mesh, "mortar");
  const MaterialLayers bricks[] = {MaterialLayers(wall.mesh, "brick"),
                                   MaterialLayers(wall.mesh, "pale_brick"),
                                   MaterialLayers(wall.mesh, "dark_brick")};
  for (int course = 0; course < 6; ++course) {
    int least = MaterialLayers::size;
    for (int x = 0; x < MaterialLayers::size; ++x) {
      int free = 0;
      for (int dy = -10; dy <= 10; ++dy) {
        const int y =
            (course * MaterialLayers::size / 6 + dy + MaterialLayers::size) % MaterialLayers::size;
        bool covered = false;
        for (const MaterialLayers& tone : bricks)
          covered |= !tone.at(x, y).empty() && tone.at(x, y).upper > mortar.at(x, y).upper;
        free += !covered;
      }
      least = std::min(least, free);
    }
    CHECK(least >= 1);
  }
}

TEST_CASE("walls of any proportion are built, and what is too wide is refused with its key") {
  CHECK_NOTHROW(read_wall({"bricks=32", "courses=2", "resolution=64"}));
  CHECK_NOTHROW(read_wall({"bricks=1", "courses=16", "resolution=64"}));
  CHECK_THROWS_WITH(read_wall({"courses=5"}), Contains("'courses' is odd"));
  CHECK_THROWS_WITH(read_wall({"joint=0.6"}), Contains("'joint' is 0.6, expected 0.01 to 0.5"));
  CHECK_THROWS_WITH(read_wall({"rounding=0.5"}), Contains("'rounding' is 0.5, expected"));
}
