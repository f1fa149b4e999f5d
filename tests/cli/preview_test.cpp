// weft preview --headless as a user calls it: a picture a pane, and what --json tells of them.
// Skipped where this machine has no EGL.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "images/image_file.h"
#include "tests/cli/program.h"
#include "tests/cli/small_scene.h"
#include "tests/temporary_folder.h"

namespace {

/// A folder with a scene (a plane seen from above in light from above) and its BTF.
struct PreviewFolder : TemporaryFolder {
  PreviewFolder() { write_small_scene(path); }
  Outcome run(std::vector<std::string> command, const std::vector<std::string>& more) const {
    command.emplace_back("scene.toml");
    command.insert(command.end(), more.begin(), more.end());
    return run_weft(command, path);
  }
  Outcome preview(const std::vector<std::string>& more) const {
    return run({"preview", "--headless", "--json", "--frames", "1"}, more);
  }
  weft::Image picture(const std::string& name) const {
    return weft::read_image(path / name, weft::Encoding::linear);
  }
};

/// Whether the preview had no EGL to draw with, which is said.
bool skipped(const Outcome& outcome) {
  const bool without_egl =
      outcome.exit_code == 1 && outcome.err.find("headless preview: ") != std::string::npos;
  if (without_egl) WARN("skipped: " << outcome.err);
  return without_egl;
}

double largest_relative_difference(const weft::Image& a, const weft::Image& b) {
  REQUIRE(a.values.size() == b.values.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    largest = std::max(largest, std::abs(a.values[i] / static_cast<double>(b.values[i]) - 1));
  return largest;
}

}  // namespace

TEST_CASE("preview --headless writes a picture a --btf, and tells of each") {
  const PreviewFolder folder;
  REQUIRE(run_weft({"compress", "small.btf", "--codec", "cmf", "-o", "small.cmf"}, folder.path)
              .exit_code == 0);
  const Outcome outcome =
      folder.preview({"--btf", "small.btf", "--btf", "cloth=small.cmf", "-o", "img.exr"});
  if (skipped(outcome)) return;
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const auto told = nlohmann::json::parse(outcome.out);
  CHECK(told["scene"] == "scene.toml");
  CHECK_FALSE(told["gpu"].get<std::string>().empty());
  CHECK(told["environment_negative_values"] == 0);
  REQUIRE(told["panes"].size() == 2);
  CHECK(told["panes"][0]["btf"] == "small.btf");
  CHECK(told["panes"][0]["picture"] == "img.0.exr");
  CHECK(told["panes"][1]["btf"] == "cloth=small.cmf");
  CHECK(told["panes"][1]["picture"] == "img.1.exr");
  for (const auto& pane : told["panes"]) {
    CHECK(pane["width"] == 8);
    CHECK(pane["height"] == 4);
    CHECK(pane["frames"] == 1);
    CHECK(pane["fps"].get<double>() > 0);
    CHECK(pane["bytes"].get<double>() > 0);
  }
  CHECK_FALSE(std::filesystem::exists(folder.path / "img.exr"));

  // The other renderer's picture; the fit of such data errs by less than a hundredth.
  REQUIRE(folder
              .run({"render"}, {"--integrator", "direct", "--filter", "centre", "--spp", "1",
                                "--no-shadows", "--lod", "0", "-o", "traced.exr"})
              .exit_code == 0);
  const weft::Image traced = folder.picture("traced.exr");
  REQUIRE(traced.width == 8);
  REQUIRE(*std::ranges::min_element(traced.values) > 0.1F);
  CHECK(largest_relative_difference(folder.picture("img.0.exr"), traced) < 1e-4);
  CHECK(largest_relative_difference(folder.picture("img.1.exr"), traced) < 0.015);
}

TEST_CASE("preview of one dataset writes the picture that was named") {
  const PreviewFolder folder;
  const Outcome outcome = folder.preview({"--size", "6x3", "-o", "img.exr"});
  if (skipped(outcome)) return;
  REQUIRE(outcome.exit_code == 0);
  CHECK(nlohmann::json::parse(outcome.out)["panes"][0]["picture"] == "img.exr");
  CHECK(folder.picture("img.exr").width == 6);
}

TEST_CASE("preview counts an environment's negative values, and draws them as 0") {
  const PreviewFolder folder;
  weft::Image sky(2, 1);
  const auto draw = [&](float odd, const std::string& name) {
    sky.set_rgb(0, 0, {1, 1, 1});
    sky.set_rgb(1, 0, {odd, 1, odd});
    weft::write_image(folder.path / "sky.exr", sky, weft::Encoding::linear);
    return folder.preview(
        {"--set", "light=[{ type = 'environment', file = 'sky.exr' }]", "-o", name});
  };
  const Outcome negative = draw(-0.5F, "negative.exr");
  if (skipped(negative)) return;
  REQUIRE(negative.exit_code == 0);
  CHECK(nlohmann::json::parse(negative.out)["environment_negative_values"] == 2);
  const Outcome zero = draw(0, "zero.exr");
  CHECK(nlohmann::json::parse(zero.out)["environment_negative_values"] == 0);
  CHECK(folder.picture("negative.exr").values == folder.picture("zero.exr").values);
}
