// weft render as a user calls it: pictures whose every pixel is known, and how it complains.

#include <algorithm>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "images/image_file.h"
#include "tests/cli/program.h"
#include "tests/cli/small_scene.h"
#include "tests/temporary_folder.h"

namespace {

/// A folder with a scene (a plane seen from above in light from above) and its BTF.
struct RenderFolder : TemporaryFolder {
  RenderFolder() { write_small_scene(path); }
  Outcome render(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"render", "scene.toml", "-o", "out.exr"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_weft(arguments, path);
  }
};

TEST_CASE("render answers with the BTF's own values, and with what it measured") {
  const RenderFolder folder;
  const Outcome outcome = folder.render(
      {"--integrator", "direct", "--filter", "centre", "--spp", "1", "--lod", "5", "--json"});
  REQUIRE(outcome.exit_code == 0);
  const auto measured = nlohmann::json::parse(outcome.out);
  CHECK(measured["width"] == 8);
  CHECK(measured["samples"] == 32);
  CHECK(measured["rays"] == 64);
  CHECK(measured["rays_per_second"] > 0);
  CHECK(measured["samples_not_finite"] == 0);
  // Level 5 is the whole tile's mean: albedos 0.1 to 0.8.
  const weft::Image image = weft::read_image(folder.path / "out.exr", weft::Encoding::linear);
  REQUIRE(image.width == 8);
  REQUIRE(image.height == 4);
  CHECK(image.rgb(3, 2).x == Approx(0.45 / std::numbers::pi * 2).epsilon(2e-3));
}

TEST_CASE("render takes BTFs by material, overrides and a file for the variance") {
  const RenderFolder folder;
  const Outcome outcome = folder.render({"--btf", "cloth=small.btf", "--set", "camera.size=[3, 2]",
                                         "--spp", "4", "--variance", "variance.exr", "--quiet"});
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.out.empty());
  CHECK(outcome.err.empty());
  CHECK(weft::read_image(folder.path / "variance.exr", weft::Encoding::linear).width == 3);
}

TEST_CASE("render refuses what it cannot do in one sentence, and leaves no picture") {
  const RenderFolder folder;
  const auto [arguments, word] = GENERATE(table<std::vector<std::string>, std::string>({
      {{"--spp", "0"}, "--spp"},
      {{"--max-bounces", "many"}, "unlimited"},
      {{"--lod", "-1"}, "--lod"},
      {{"--filter", "bxo"}, "centre"},
      {{"--btf", "gone.btf"}, "gone.btf"},
      {{"--btf", "silk=small.btf"}, "cloth"},
      {{"--btf", "small.btf", "--btf", "small.btf"}, "--btf"},
      {{"--set", "camera.fow=3"}, "fow"},
  }));
  const Outcome outcome = folder.render(arguments);
  CHECK(outcome.exit_code == 2);
  CHECK_THAT(outcome.err, Catch::Contains(word));
  CHECK_FALSE(std::filesystem::exists(folder.path / "out.exr"));
}

TEST_CASE("A level that nothing in the scene has is refused") {
  const RenderFolder folder;
  REQUIRE(run_weft({"compress", "small.btf", "-o", "small.cmf", "--set", "clustered=false", "--set",
                    "levels=false"},
                   folder.path)
              .exit_code == 0);
  const auto draw = [&](const std::vector<std::string>& command, const std::string& lod) {
    std::vector<std::string> arguments = command;
    for (const char* more : {"scene.toml", "-o", "out.exr", "--btf", "small.cmf", "--lod"})
      arguments.emplace_back(more);
    arguments.push_back(lod);
    return run_weft(arguments, folder.path);
  };
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"render", "--spp", "1"},
        std::vector<std::string>{"preview", "--headless"}}) {
    const Outcome outcome = draw(command, "1");
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Catch::Contains("--lod") && Catch::Contains("levels"));
    CHECK_FALSE(std::filesystem::exists(folder.path / "out.exr"));
  }
  CHECK(draw({"render", "--spp", "1"}, "0").exit_code == 0);
  CHECK(draw({"render", "--spp", "1"}, "auto").exit_code == 0);
}

TEST_CASE("An environment's negative values are 0, counted and warned of, but not with --quiet") {
  const RenderFolder folder;
  weft::Image sky(2, 1);
  std::ranges::fill(sky.values, 1.0F);
  const auto draw = [&](float odd, const std::string& how) {
    sky.set_rgb(1, 0, {odd, odd, 1});
    weft::write_image(folder.path / "sky.exr", sky, weft::Encoding::linear);
    return folder.render(
        {"--set", "light=[{ type = 'environment', file = 'sky.exr' }]", "--spp", "4", how});
  };
  const auto picture = [&] {
    return weft::read_image(folder.path / "out.exr", weft::Encoding::linear).values;
  };
  const Outcome told = draw(-0.001F, "--json");
  REQUIRE(told.exit_code == 0);
  CHECK(nlohmann::json::parse(told.out)["environment_negative_values"] == 2);
  CHECK_THAT(told.err, Catch::Contains("warning") && Catch::Contains("sky.exr: 2 of 6 values"));
  const std::vector<float> clamped = picture();
  CHECK(draw(-0.001F, "--quiet").err.empty());
  const Outcome zero = draw(0, "--json");
  CHECK(nlohmann::json::parse(zero.out)["environment_negative_values"] == 0);
  CHECK(zero.err.empty());
  CHECK(picture() == clamped);
}

TEST_CASE("render and preview read an environment alike, and refuse the same pixels") {
  const RenderFolder folder;
  weft::Image sky(2, 1);
  const std::vector<std::vector<std::string>> commands = {{"render", "--spp", "1"},
                                                          {"preview", "--headless"}};
  const auto draw = [&](std::vector<std::string> arguments, float odd) {
    sky.set_rgb(1, 0, {odd, 1, 1});
    weft::write_image(folder.path / "sky.exr", sky, weft::Encoding::linear);
    for (const char* more : {"scene.toml", "-o", "out.exr", "--set",
                             "light=[{ type = 'environment', file = 'sky.exr' }]"}) {
      arguments.emplace_back(more);
    }
    return run_weft(arguments, folder.path);
  };
  for (const std::vector<std::string>& command : commands) {
    INFO(command[0]);
    for (const float odd :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
      const Outcome refused = draw(command, odd);
      CHECK(refused.exit_code == 2);
      CHECK_THAT(refused.err, Catch::Contains("sky.exr: pixel x = 1, y = 0"));
      CHECK_FALSE(std::filesystem::exists(folder.path / "out.exr"));
    }
  }
  // Before anything is drawn, so that this holds without EGL too.
  for (const std::vector<std::string>& command : commands) {
    CHECK_THAT(draw(command, -1).err, Catch::Contains("sky.exr: 1 of 6 values were negative"));
  }
}

TEST_CASE("A scene without light is warned of, but not with --quiet") {
  const RenderFolder folder;
  const std::vector<std::string> dark = {"--set", "light=[]", "--spp", "1", "--json"};
  const Outcome told = folder.render(dark);
  CHECK(told.exit_code == 0);
  CHECK_THAT(told.err, Catch::Contains("warning") && Catch::Contains("no light"));
  std::vector<std::string> quiet = dark;
  quiet.back() = "--quiet";
  CHECK(folder.render(quiet).err.empty());
}

}  // namespace
