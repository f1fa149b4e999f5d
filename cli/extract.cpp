// weft extract: one tile of a BTF, raw or compressed, seen with a chosen view and light: the
// software renderer of Suykens et al., "Interactive Rendering with Bidirectional Texture Functions"
// (2003), figure 3.

#include <fmt/core.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>

#include "btf/error.h"
#include "cli/command.h"
#include "cli/option_checks.h"
#include "codecs/representation.h"
#include "images/image_file.h"

namespace weft::cli {

namespace {

struct ExtractOptions {
  std::filesystem::path input;
  std::filesystem::path output;
  std::vector<double> view;
  std::vector<double> light;
  std::string size;
  float lod = 0;
  double scale = 0;  // 0: by the format
};

Direction parse_direction(const std::string& option, const std::vector<double>& angles) {
  const double theta = angles[0];
  if (!(theta >= 0 && theta < 90) || !std::isfinite(angles[1])) {
    throw bad_input(option, fmt::format("theta is {}, phi is {}", theta, angles[1]),
                    "theta is in degrees from the normal, 0 <= theta < 90");
  }
  return from_spherical(radians(theta), radians(angles[1]));
}

Imath::V2i parse_size(const std::string& text) {
  int width = 0;
  int height = 0;
  char rest = 0;
  const bool parsed = std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest) == 2;
  if (!parsed || width < 1 || height < 1 || width > 16384 || height > 16384) {
    throw bad_input("--size", fmt::format("'{}' is not a size", text),
                    "write WIDTHxHEIGHT, each from 1 to 16384, such as 256x256");
  }
  return {width, height};
}

/// One pixel a texel of the level that `lod` rounds down to.
Imath::V2i size_of_level(Imath::V2i texels, float lod) {
  for (int level = 0; level < static_cast<int>(lod); ++level) {
    texels = {std::max(1, texels.x / 2), std::max(1, texels.y / 2)};
  }
  return texels;
}

bool holds_floats(const std::filesystem::path& path) {
  const auto extension = path.extension();
  return extension == ".exr" || extension == ".hdr" || extension == ".pfm";
}

Image render_tile(const Appearance& tile, Imath::V2i size, const Direction& light,
                  const Direction& view, float lod) {
  Image image(size.x, size.y);
  oneapi::tbb::parallel_for(0, size.y, [&](int y) {
    std::vector<AppearanceQuery> queries(static_cast<std::size_t>(size.x));
    std::vector<Rgb> answers(queries.size());
    const float v = 1.0F - (static_cast<float>(y) + 0.5F) / static_cast<float>(size.y);
    for (int x = 0; x < size.x; ++x) {
      queries[x] = {
          {(static_cast<float>(x) + 0.5F) / static_cast<float>(size.x), v}, light, view, lod};
    }
    tile.evaluate(queries, answers);
    for (int x = 0; x < size.x; ++x) image.set_rgb(x, y, answers[x]);
  });
  return image;
}

Rgb mean_of(const Image& image) {
  Imath::V3d sum(0.0);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) sum += Imath::V3d(image.rgb(x, y));
  }
  return Rgb(sum / (static_cast<double>(image.width) * image.height));
}

void extract(const ExtractOptions& options, Session& session) {
  const Direction view = parse_direction("--view", options.view);
  const Direction light = parse_direction("--light", options.light);
  check_image_path(options.output);
  const auto tile = open_representation(options.input);
  if (options.lod > 0 && !tile->has_lod()) {
    throw bad_input("--lod", fmt::format("the codec {} holds level 0 only", tile->codec()));
  }
  const Imath::V2i size =
      options.size.empty() ? size_of_level(tile->texels(), options.lod) : parse_size(options.size);

  const auto begin = std::chrono::steady_clock::now();
  Image image = render_tile(*tile, size, light, view, options.lod);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const Rgb mean = mean_of(image);

  const double natural = holds_floats(options.output) ? 1.0 : std::numbers::pi;
  const auto scale = static_cast<float>(options.scale > 0 ? options.scale : natural);
  for (float& value : image.values) value *= scale;
  write_image(options.output, image, Encoding::colour);

  session.measured["output"] = options.output.string();
  session.measured["codec"] = tile->codec();
  session.measured["size"] = {size.x, size.y};
  session.measured["mean"] = {mean.x, mean.y, mean.z};
  session.measured["scale"] = scale;
  session.measured["seconds"] = seconds;
  session.say(fmt::format("{}: {} x {}, mean ({:.5g}, {:.5g}, {:.5g}) 1/sr",
                          options.output.string(), size.x, size.y, mean.x, mean.y, mean.z));
}

}  // namespace

void add_extract(CLI::App& app, Session& session) {
  const auto options = std::make_shared<ExtractOptions>();
  CLI::App* command = app.add_subcommand(
      "extract", "Writes the picture of one tile, seen with one view and one light");
  command->add_option("input", options->input, "Dataset folder, raw or compressed")->required();
  command->add_option("-o,--output", options->output, "Picture; .exr keeps the values")->required();
  command->add_option("--view", options->view, "theta,phi of the viewer in degrees, such as 30,180")
      ->required()
      ->delimiter(',')
      ->expected(2);
  command->add_option("--light", options->light, "theta,phi of the light in degrees")
      ->required()
      ->delimiter(',')
      ->expected(2);
  command->add_option("--size", options->size,
                      "WIDTHxHEIGHT in pixels; default: one pixel a texel");
  command
      ->add_option("--lod", options->lod,
                   "log2 of the footprint's width in texels; 0: the finest level")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 16.0));
  command
      ->add_option(
          "--scale", options->scale,
          "Factor on the values; default: 1 for float formats, pi for 8-bit ones, where a white "
          "Lambertian tile under a light overhead is white then")
      ->check(above(0));
  command->callback([options, &session] { extract(*options, session); });
}

}  // namespace weft::cli
