// Scene files: what they say, and how they complain.

#include "tracer/scene_file.h"

#include <fstream>

#include "btf/error.h"
#include "images/image_file.h"
#include "tests/temporary_folder.h"
#include "tests/tracer/test_scenes.h"

namespace weft {
namespace {

const std::string small_scene =
    R"(camera = { type = "perspective", eye = [0, -4, 2], fov = 50, size = [40, 30] }
light = [ { type = "point", position = [1, 2, 3], intensity = 5 }, { type = "directional", direction = [0, 0, 2] } ]
shape = [ { type = "torus", material = "weave", segments = 16, tube_segments = 8 } ]
[material.weave]
type = "btf"
file = "weave.btf"
repeat = [8, 4]
)";

/// Reads a scene whose text is `text`; `opened` tells which BTFs were asked for.
struct Reading {
  TemporaryFolder folder;
  std::vector<std::filesystem::path> opened;

  Scene read(const std::string& text, const std::map<std::string, std::filesystem::path>& btfs = {},
             const std::vector<std::string>& overrides = {}) {
    std::ofstream(folder.path / "scene.toml") << text;
    const auto open = [&](const std::filesystem::path& path) {
      opened.push_back(path);
      return std::make_shared<FunctionAppearance>(
          [](const AppearanceQuery&) { return Rgb(1, 1, 1); }, 16);
    };
    return read_scene(folder.path / "scene.toml", open, btfs, overrides);
  }
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST_CASE("A scene file is read as it says", "[scene]") {
  Reading reading;
  const Scene scene = reading.read(small_scene);
  CHECK(scene.camera.eye == Vec3(0, -4, 2));
  CHECK(scene.camera.fov == 50);
  CHECK(scene.camera.width == 40);
  CHECK(scene.camera.height == 30);
  REQUIRE(scene.point_lights.size() == 1);
  CHECK(scene.point_lights[0].intensity == Rgb(5, 5, 5));
  REQUIRE(scene.directional_lights.size() == 1);
  CHECK(scene.directional_lights[0].direction == Vec3(0, 0, 1));
  REQUIRE(scene.shapes.size() == 1);
  REQUIRE(scene.materials.size() == 1);
  CHECK(scene.materials[scene.shapes[0].material].name == "weave");
  CHECK(scene.materials[0].repeat == Vec2(8, 4));
  // Relative to the scene file.
  CHECK(reading.opened == std::vector{reading.folder.path / "weave.btf"});
}

TEST_CASE("BTFs and keys are replaced from outside", "[scene]") {
  Reading reading;
  reading.read(small_scene, {{"", "all.btf"}});
  reading.read(small_scene, {{"", "all.btf"}, {"weave", "one.btf"}});
  CHECK(reading.opened == std::vector<std::filesystem::path>{"all.btf", "one.btf"});
  CHECK(reading.read(small_scene, {}, {"camera.size=[8, 9]"}).camera.height == 9);
  CHECK_THROWS_WITH(reading.read(small_scene, {{"wave", "x.btf"}}),
                    Catch::Contains("wave") && Catch::Contains("weave"));
  CHECK_THROWS_WITH(reading.read(small_scene, {}, {"camera.fow=3"}), Catch::Contains("fow"));
}

TEST_CASE("Plain materials and environments", "[scene]") {
  Reading reading;
  Image image(8, 4, 1);
  image.values[2] = 3;
  write_image(reading.folder.path / "sky.exr", image, Encoding::linear);
  const Scene scene = reading.read(R"(
shape = [ { type = "plane", material = "chalk" } ]
light = [ { type = "environment", file = "sky.exr", scale = 2, rotate = 90 }, { type = "environment", radiance = [1, 2, 3] } ]
material = { chalk = { type = "lambert", albedo = 0.5 } }
)");
  REQUIRE(scene.environments.size() == 2);
  CHECK(scene.environments[0].radiance.rgb(2, 0) == Rgb(6, 6, 6));
  CHECK(scene.environments[0].rotate == Approx(std::numbers::pi / 2));
  CHECK(scene.environments[1].radiance.rgb(0, 0) == Rgb(1, 2, 3));
  const Rgb value = scene.materials[0].appearance->evaluate({0, 0}, {0, 0, 1}, {0, 0, 1}, 0);
  CHECK(value.x == Approx(0.5 / std::numbers::pi));
}

TEST_CASE("A mesh without texture coordinates cannot wear a texture", "[scene]") {
  Reading reading;
  std::ofstream(reading.folder.path / "bare.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(reading.folder.path / "dressed.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
  const std::string with =
      replaced(small_scene, R"(type = "torus")", R"(type = "mesh", file = "dressed.obj")");
  const std::string mesh_scene = replaced(with, ", segments = 16, tube_segments = 8", "");
  const Scene scene = reading.read(mesh_scene);
  CHECK(scene.shapes[0].mesh.tangents.at(0) == Vec3(1, 0, 0));
  CHECK_THROWS_WITH(reading.read(replaced(mesh_scene, "dressed", "bare")),
                    Catch::Contains("texture coordinates"));
  CHECK_THROWS_WITH(reading.read(replaced(mesh_scene, "dressed", "gone")),
                    Catch::Contains("gone.obj"));
}

TEST_CASE("Errors name the line and what is valid", "[scene]") {
  Reading reading;
  const auto complaint = [&](const std::string& from, const std::string& to) -> std::string {
    try {
      reading.read(replaced(small_scene, from, to));
    } catch (const Error& error) {
      CHECK(error.kind() == Error::Kind::bad_input);
      return error.what();
    }
    return "no error";
  };
  using Catch::Contains;
  CHECK_THAT(complaint("repeat", "repaet"),
             Contains("scene.toml:7") && Contains("repaet") && Contains("repeat"));
  CHECK_THAT(complaint("\"torus\"", "\"tours\""), Contains("scene.toml:3") && Contains("torus"));
  CHECK_THAT(complaint("\"point\"", "\"pont\""), Contains("scene.toml:2") && Contains("point"));
  CHECK_THAT(complaint("\"weave\", seg", "\"wave\", seg"),
             Contains("scene.toml:3") && Contains("weave"));
  CHECK_THAT(complaint("type = \"btf\"", "type = \"bft\""),
             Contains("scene.toml:5") && Contains("btf"));
  CHECK_THAT(complaint("[40, 30]", "[40, 0]"), Contains("scene.toml:1") && Contains("size"));
  CHECK_THAT(complaint("eye = [0, -4, 2]", "eye = [0, 0, 0]"),
             Contains("scene.toml:1") && Contains("same point"));
  CHECK_THAT(complaint("fov = 50", "fov = 200"), Contains("scene.toml:1") && Contains("fov"));
  CHECK_THAT(complaint("position", "positoin"), Contains("scene.toml:2") && Contains("position"));
  CHECK_THAT(complaint("[0, 0, 2]", "[0, 0, 0]"),
             Contains("scene.toml:2") && Contains("direction"));
  CHECK_THAT(complaint("file = \"weave.btf\"", ""), Contains("file"));
  CHECK_THAT(complaint("type = \"torus\", ", ""), Contains("scene.toml:3") && Contains("type"));
  CHECK_THAT(complaint("shape", "shaep"), Contains("shaep") || Contains("shape"));
  CHECK_THROWS_AS(read_scene(reading.folder.path / "gone.toml", nullptr), Error);
}

}  // namespace
}  // namespace weft
