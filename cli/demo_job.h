// One BTF of the demo from its mesostructure to pictures and errors: calls each part in turn, keeps
// what is whole.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "gl_preview/headless.h"
#include "study/metrics.h"
#include "tracer/render.h"

namespace weft::cli {

struct DemoSettings {
  std::filesystem::path folder = "demo";
  std::filesystem::path scenes;
  std::string directions = "ubo81";
  std::string codec = "cmf";
  int texels = 64;         ///< columns and rows of a tile
  int spp = 16;            ///< eye paths a (view, texel)
  int max_bounces = 4;     ///< of acquisition and of the path tracer
  int picture_size = 480;  ///< pixels, columns and rows
  int picture_spp = 32;
  int frames = 10;  ///< timed in the preview
  std::uint64_t seed = 0;
  bool quiet = false;
};

/// What a row of the demo's table of BTFs says.
struct DemoItem {
  std::string name;   ///< of scenes/mesostructures/NAME.toml
  std::string shape;  ///< in words
  std::string scene;  ///< scenes/SCENE
};

/// One representation of a BTF, rendered twice.
struct DemoVariant {
  std::string codec;
  std::size_t bytes = 0;  ///< as uploaded
  std::size_t constant_bytes = 0;
  std::uintmax_t file_bytes = 0;
  double ratio = 0;
  double seconds = 0;  ///< to make it: tracing the raw one, fitting the other
  RenderResult traced;
  HeadlessPicture previewed;
};

struct DemoResult {
  DemoItem item;
  bool kept =
      false;  ///< the raw dataset was there already; its times are those of the run that made it
  nlohmann::ordered_json acquired;  ///< what acquisition measured
  DemoVariant raw;
  DemoVariant compressed;
  ImageDifference traced;     ///< compressed against raw, path tracer
  ImageDifference previewed;  ///< the same, preview
};

/// Datasets go to `settings.folder`/data. Those that are whole and of the same settings are kept,
/// an interrupted one is continued. @throws Error as the parts do.
DemoResult run_demo_item(const DemoItem& item, const DemoSettings& settings);

/// Everything measured about one BTF.
nlohmann::ordered_json measured_of(const DemoResult& result);

}  // namespace weft::cli
