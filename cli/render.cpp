// weft render: a scene file through the path tracer to a picture.

#include <fmt/core.h>

#include <charconv>
#include <optional>

#include "btf/error.h"
#include "cli/btf_option.h"
#include "cli/command.h"
#include "cli/lod_option.h"
#include "cli/option_checks.h"
#include "cli/scene_light.h"
#include "images/image_file.h"
#include "tracer/render.h"
#include "tracer/scene_file.h"

namespace weft::cli {
namespace {

const std::map<std::string, Integrator> integrators{{"path", Integrator::path},
                                                    {"direct", Integrator::direct}};
const std::map<std::string, PixelFilter> filters{{"box", PixelFilter::box},
                                                 {"centre", PixelFilter::centre},
                                                 {"gaussian", PixelFilter::gaussian}};

template <typename T>
std::vector<std::string> names_of(const std::map<std::string, T>& values) {
  std::vector<std::string> names;
  for (const auto& [name, value] : values) names.push_back(name);
  return names;
}

struct RenderOptions {
  std::string scene;
  std::vector<std::string> btfs;
  std::string output;
  std::string variance;
  std::vector<std::string> overrides;
  std::string max_bounces = "8";
  std::string lod = "auto";
  std::string integrator = "path";
  std::string filter = "box";
  bool no_shadows = false;
  RenderSettings settings;
};

/// By material, or for all under "", as `read_scene` takes them.
std::map<std::string, std::filesystem::path> btf_paths(const std::vector<std::string>& btfs) {
  std::map<std::string, std::filesystem::path> paths;
  for (const std::string& text : btfs) {
    const BtfOption btf = parse_btf_option(text);
    if (!paths.emplace(btf.material, btf.path).second) {
      throw bad_input("--btf " + text, "another --btf stands for the same material already",
                      "name each material once: --btf MATERIAL=PATH");
    }
  }
  return paths;
}

/// A whole number of at least 0, or nothing where `text` is not one.
std::optional<int> whole_number(const std::string& text) {
  int value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

int parse_max_bounces(const std::string& text) {
  if (text == "unlimited") return RenderSettings::unlimited_bounces;
  const std::optional<int> bounces = whole_number(text);
  if (!bounces)
    throw bad_input("--max-bounces",
                    "found '" + text + "', expected a whole number or 'unlimited'");
  return *bounces;
}

void report(const RenderStatistics& statistics, const Image& image, Session& session) {
  const double seconds = std::max(statistics.seconds, 1e-9);
  session.measured["width"] = image.width;
  session.measured["height"] = image.height;
  session.measured["seconds"] = statistics.seconds;
  session.measured["build_seconds"] = statistics.build_seconds;
  session.measured["samples"] = statistics.samples;
  session.measured["samples_per_second"] = statistics.samples / seconds;
  session.measured["rays"] = statistics.rays;
  session.measured["rays_per_second"] = statistics.rays / seconds;
  session.measured["evaluations"] = statistics.evaluations;
  session.measured["evaluations_per_second"] = statistics.evaluations / seconds;
  session.measured["samples_not_finite"] = statistics.invalid.not_finite;
  session.measured["samples_negative"] = statistics.invalid.negative;
  session.say(fmt::format(
      "{} x {} pixels in {:.2f} s: {:.3g} samples/s, {:.3g} rays/s, {:.3g} evaluations/s",
      image.width, image.height, statistics.seconds, statistics.samples / seconds,
      statistics.rays / seconds, statistics.evaluations / seconds));
  if (statistics.invalid.first) {
    fmt::print(stderr,
               "weft: warning: {} of {} samples were NaN or infinite and were left out, first at x "
               "= {}, y = {}\n",
               statistics.invalid.not_finite, statistics.samples, (*statistics.invalid.first)[0],
               (*statistics.invalid.first)[1]);
  }
  if (statistics.invalid.negative > 0) {
    fmt::print(stderr, "weft: warning: {} of {} samples were negative; they are used as they are\n",
               statistics.invalid.negative, statistics.samples);
  }
}

void run(RenderOptions& options, Session& session) {
  options.settings.max_bounces = parse_max_bounces(options.max_bounces);
  options.settings.lod = parse_lod(options.lod);
  options.settings.integrator = integrators.at(options.integrator);
  options.settings.filter = filters.at(options.filter);
  options.settings.shadows = !options.no_shadows;
  options.settings.seed = session.seed;
  check_image_path(options.output);
  if (!options.variance.empty()) check_image_path(options.variance);
  const Scene scene =
      read_scene(options.scene, open_datasets(), btf_paths(options.btfs), options.overrides);
  check_levels(options.settings.lod, has_levels(scene));
  report_light(scene, session);
  Progress progress("render", session.quiet || session.json);
  const RenderResult result = render(scene, options.settings, progress);
  write_image(options.output, result.image, Encoding::colour);
  if (!options.variance.empty()) write_image(options.variance, result.variance, Encoding::linear);
  report(result.statistics, result.image, session);
}

}  // namespace

void add_render(CLI::App& app, Session& session) {
  CLI::App* command = app.add_subcommand("render", "Render a scene file with the path tracer");
  auto options = std::make_shared<RenderOptions>();
  command->add_option("scene", options->scene, "Scene file (TOML)")
      ->required()
      ->type_name("SCENE.toml");
  const auto name = [&](const std::string& flag, std::string& value, const std::string& text) {
    return command->add_option(flag, value, text)->capture_default_str();
  };
  command
      ->add_option("-o,--output", options->output,
                   "Picture to write: .exr (linear), .png (sRGB), …")
      ->required()
      ->type_name("FILE");
  command
      ->add_option(
          "--btf", options->btfs,
          "BTF for every btf material of the scene, raw or compressed, or for one; may be repeated")
      ->type_name("[MATERIAL=]PATH")
      ->allow_extra_args(false);
  command
      ->add_option("--set", options->overrides,
                   "Override a key of the scene file, e.g. camera.size=[400,400]; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  name("--integrator", options->integrator, "path, or direct: light that was reflected once")
      ->check(one_of(names_of(integrators)));
  command->add_option("--spp", options->settings.samples_per_pixel, "Samples a pixel")
      ->check(CLI::Range(1, 1 << 24))
      ->capture_default_str();
  name("--max-bounces", options->max_bounces, "Reflections after the first, or 'unlimited'")
      ->type_name("N");
  name("--filter", options->filter,
       "Where a pixel's samples lie: box (all over it), centre, gaussian (sigma half a pixel)")
      ->check(one_of(names_of(filters)));
  command->add_flag("--no-shadows", options->no_shadows,
                    "Nothing stands in a light's way (for comparing with the preview)");
  name("--lod", options->lod,
       "Level of detail: auto (a pixel's footprint), or log2 of a width in texels")
      ->type_name("auto|X");
  command
      ->add_option("--variance", options->variance,
                   "Also write the variance of each pixel's value here")
      ->type_name("FILE");
  command->callback([options, &session] { run(*options, session); });
}

}  // namespace weft::cli
