// Negative values of an environment's file are 0 and counted; NaN and infinity are refused.

#include "tracer/lights/environment_radiance.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include "btf/error.h"
#include "images/image_file.h"
#include "tests/temporary_folder.h"
#include "tests/tracer/test_scenes.h"
#include "tracer/lights/environment_sampler.h"
#include "tracer/scene_file.h"

namespace weft {
namespace {

namespace fs = std::filesystem;

/// A grey ball in the light of one picture.
Scene lit_by(const fs::path& picture, const std::string& more = "") {
  const TemporaryFolder folder;
  std::ofstream(folder.path / "scene.toml")
      << "camera = { eye = [0, -4, 1], size = [16, 16] }\n"
      << "shape = [ { type = \"sphere\", material = \"chalk\" } ]\n"
      << "light = [ { type = \"environment\", file = \"" << picture.string() << "\"" << more
      << " } ]\n"
      << "material = { chalk = { type = \"lambert\", albedo = 0.5 } }\n";
  const auto none = [](const fs::path&) { return std::shared_ptr<const Appearance>(); };
  return read_scene(folder.path / "scene.toml", none);
}

/// Bright everywhere but for three values, which are `odd`.
Image sky_with(float odd) {
  Image sky(8, 4);
  std::ranges::fill(sky.values, 2.0F);
  for (const std::size_t i : {7, 40, 41}) sky.values[i] = odd;
  return sky;
}

fs::path written(const TemporaryFolder& folder, const std::string& name, const Image& image) {
  write_image(folder.path / name, image, Encoding::linear);
  return folder.path / name;
}

fs::path reference_folder() {
  const char* shared = std::getenv("WEFT_SHARED");
  const fs::path root = shared != nullptr ? shared : fs::path(WEFT_SOURCE_DIR) / "../shared";
  return fs::absolute(root) / "reference/environments";
}

TEST_CASE("A map with negative values lights as the same map with zeros", "[environment]") {
  const TemporaryFolder folder;
  const Scene negative = lit_by(written(folder, "negative.exr", sky_with(-0.0016F)));
  const Scene zero = lit_by(written(folder, "zero.exr", sky_with(0)));
  CHECK(negative.environments[0].negative_values == 3);
  CHECK(zero.environments[0].negative_values == 0);
  CHECK(negative.environments[0].radiance.values == zero.environments[0].radiance.values);
  RenderSettings settings;
  settings.samples_per_pixel = 4;
  const Image picture = render_quietly(negative, settings).image;
  CHECK(picture.values == render_quietly(zero, settings).image.values);
  CHECK(std::ranges::max(picture.values) > 0);
}

TEST_CASE("Values are counted as the file has them, whatever the scale", "[environment]") {
  const TemporaryFolder folder;
  const fs::path file = written(folder, "sky.exr", sky_with(-1));
  CHECK(lit_by(file, ", scale = 0").environments[0].negative_values == 3);
  CHECK(lit_by(file, ", scale = 1e12").environments[0].negative_values == 3);
}

TEST_CASE("NaN and infinity are refused with file and pixel", "[environment]") {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const TemporaryFolder folder;
  for (const float odd : {std::numeric_limits<float>::quiet_NaN(), infinity, -infinity}) {
    INFO(odd);
    const fs::path file = written(folder, "sky.exr", sky_with(odd));
    CHECK_THROWS_WITH(lit_by(file), Catch::Contains("sky.exr: pixel x = 2, y = 0"));
  }
  // What the scale makes infinite is no radiance either.
  const fs::path bright = written(folder, "bright.exr", sky_with(1e30F));
  CHECK_THROWS_WITH(lit_by(bright, ", scale = 1e12"),
                    Catch::Contains("bright.exr: pixel x = 2, y = 0"));
}

TEST_CASE("Maps of real light are read", "[environment]") {
  if (!fs::exists(reference_folder())) {
    WARN("skipped: " << reference_folder() << " is not there");
    return;
  }
  // As oiiotool --rangecheck counts them, a channel at a time.
  const std::pair<const char*, std::int64_t> maps[] = {{"city.exr", 161 + 154 + 191},
                                                       {"forest.exr", 784}};
  for (const auto& [name, negative_values] : maps) {
    INFO(name);
    const Scene scene = lit_by(reference_folder() / name);
    const EnvironmentLight& light = scene.environments[0];
    CHECK(light.radiance.width == 1024);
    CHECK(light.negative_values == negative_values);
    CHECK(std::ranges::min(light.radiance.values) == 0);
    CHECK_NOTHROW(EnvironmentSampler(light));
  }
}

}  // namespace
}  // namespace weft
