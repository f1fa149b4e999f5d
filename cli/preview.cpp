// weft preview: a scene drawn by OpenGL, in a window or headless, each --btf in a pane of its own.

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "btf/error.h"
#include "cli/btf_option.h"
#include "cli/command.h"
#include "cli/lod_option.h"
#include "cli/scene_light.h"
#include "gl_preview/headless.h"
#include "gl_preview/window.h"
#include "images/image_file.h"
#include "tracer/scene_file.h"

namespace weft::cli {

namespace {

constexpr int timed_frames_by_default = 5;

struct PreviewArguments {
  std::filesystem::path scene;
  std::vector<std::string> btfs;
  std::vector<std::string> overrides;
  std::filesystem::path output;
  std::filesystem::path screenshot;
  std::string size;
  std::string lod = "0";
  std::optional<int> frames;
  bool headless = false;
  bool no_shadows = false;
};

/// "WxH" to the camera's size.
void set_size(Camera& camera, const std::string& text) {
  if (text.empty()) return;
  int width = 0;
  int height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest) != 2 || width < 1 ||
      height < 1 || width > 16384 || height > 16384) {
    throw bad_input("--size", "'" + text + "' is not a size",
                    "write WIDTHxHEIGHT, each from 1 to 16384, such as 800x600");
  }
  camera.width = width;
  camera.height = height;
}

/// "img.exr" is "img.1.exr" for the second of several panes.
std::filesystem::path picture_path(const std::filesystem::path& output, std::size_t pane,
                                   std::size_t panes) {
  if (panes == 1) return output;
  std::filesystem::path path = output;
  path.replace_extension("." + std::to_string(pane) + output.extension().string());
  return path;
}

std::vector<PreviewPane> open_panes(const PreviewArguments& arguments) {
  const OpenAppearance open = open_datasets();
  const auto pane = [&](const std::string& title,
                        const std::map<std::string, std::filesystem::path>& paths) {
    PreviewPane result{title, read_scene(arguments.scene, open, paths, arguments.overrides)};
    set_size(result.scene.camera, arguments.size);
    return result;
  };
  std::vector<PreviewPane> panes;
  for (const std::string& text : arguments.btfs) {
    const BtfOption btf = parse_btf_option(text);
    panes.push_back(pane(text, {{btf.material, btf.path}}));
  }
  if (panes.empty()) panes.push_back(pane(arguments.scene.filename().string(), {}));
  return panes;
}

/// The level to draw. One pane with levels is enough: beside it stands what has none.
std::optional<float> lod_of(const PreviewArguments& arguments,
                            const std::vector<PreviewPane>& panes) {
  const std::optional<float> lod = parse_lod(arguments.lod);
  check_levels(lod, std::ranges::any_of(
                        panes, [](const PreviewPane& pane) { return has_levels(pane.scene); }));
  return lod;
}

void tell_about_light(const Scene& scene, Session& session) {
  report_light(scene, session);
  if (scene.environments.empty()) return;
  session.say(
      fmt::format("Environment light is shown as {} directional lights, and not behind the scene.",
                  lights_per_environment));
}

void preview_headless(const PreviewArguments& arguments, Session& session) {
  const std::vector<PreviewPane> panes = open_panes(arguments);
  const HeadlessOptions options{lod_of(arguments, panes),
                                arguments.frames.value_or(timed_frames_by_default)};
  tell_about_light(panes.front().scene, session);
  for (std::size_t i = 0; i < panes.size(); ++i) {
    const HeadlessPicture picture = weft::preview_headless(panes[i].scene, options);
    const std::filesystem::path path = picture_path(arguments.output, i, panes.size());
    write_image(path, picture.image, Encoding::colour);
    const double fps = picture.ms_per_frame > 0 ? 1000 / picture.ms_per_frame : 0;
    session.say(fmt::format("{}: {} x {}, {:.1f} ms a frame ({:.1f} fps), textures {:.2f} MB -> {}",
                            panes[i].title, picture.image.width, picture.image.height,
                            picture.ms_per_frame, fps, static_cast<double>(picture.bytes) * 1e-6,
                            path.string()));
    session.measured["gpu"] = picture.renderer;
    session.measured["panes"].push_back({{"btf", panes[i].title},
                                         {"picture", path.string()},
                                         {"width", picture.image.width},
                                         {"height", picture.image.height},
                                         {"frames", options.timed_frames},
                                         {"ms_per_frame", picture.ms_per_frame},
                                         {"best_ms", picture.best_ms},
                                         {"fps", fps},
                                         {"upload_ms", picture.upload_ms},
                                         {"bytes", picture.bytes}});
  }
}

void preview_in_window(const PreviewArguments& arguments, Session& session) {
  std::vector<PreviewPane> panes = open_panes(arguments);
  const std::optional<float> lod = lod_of(arguments, panes);
  tell_about_light(panes.front().scene, session);
  std::vector<std::string> titles;
  for (const PreviewPane& pane : panes) titles.push_back(pane.title);
  const WindowResult result =
      preview_window(std::move(panes), {lod, arguments.frames.value_or(0), arguments.screenshot});
  session.measured["gpu"] = result.renderer;
  session.measured["frames"] = result.frames;
  for (std::size_t i = 0; i < titles.size(); ++i) {
    const double ms = result.ms_per_frame[i];
    session.measured["panes"].push_back({{"btf", titles[i]},
                                         {"ms_per_frame", ms},
                                         {"fps", ms > 0 ? 1000 / ms : 0},
                                         {"bytes", result.bytes[i]}});
  }
}

void preview(const PreviewArguments& arguments, Session& session) {
  session.measured["command"] = "preview";
  session.measured["scene"] = arguments.scene.string();
  if (!arguments.output.empty()) check_image_path(arguments.output);
  if (!arguments.screenshot.empty()) check_image_path(arguments.screenshot);
  if (!arguments.headless) return preview_in_window(arguments, session);
  if (arguments.output.empty()) {
    throw bad_input("--headless", "has no file to draw to", "add -o FILE.exr");
  }
  preview_headless(arguments, session);
}

}  // namespace

void add_preview(CLI::App& app, Session& session) {
  auto* command =
      app.add_subcommand("preview",
                         "Draws a scene with OpenGL: in a window (orbit, light drag, error map), "
                         "or headless to a file. Light "
                         "arrives directly, without cast shadows; the background is black.");
  auto a = std::make_shared<PreviewArguments>();
  command->add_option("scene", a->scene, "Scene file (TOML)")->required()->type_name("SCENE.toml");
  command
      ->add_option("--btf", a->btfs,
                   "Dataset in place of every BTF material, or of one; each --btf is a pane, and "
                   "the first is "
                   "the reference of the error map")
      ->type_name("[MATERIAL=]PATH")
      ->allow_extra_args(false);
  auto* headless = command->add_flag("--headless", a->headless,
                                     "Draw to a file, without window or display (EGL)");
  command
      ->add_option(
          "-o,--output", a->output,
          "Picture of --headless, linear in .exr; with several --btf img.exr becomes img.0.exr, "
          "img.1.exr, ...")
      ->type_name("FILE")
      ->needs(headless);
  command->add_option("--size", a->size, "Pixels; the scene's camera says otherwise")
      ->type_name("WxH");
  command
      ->add_option("--lod", a->lod,
                   "Level of detail: log2 of a width in texels, 0 the finest; or auto: each "
                   "pixel's footprint")
      ->capture_default_str()
      ->type_name("auto|X");
  command
      ->add_option(
          "--frames", a->frames,
          fmt::format("Headless: frames to time ({} by default). Window: close after so many",
                      timed_frames_by_default))
      ->type_name("N")
      ->check(CLI::Range(0, 1'000'000));
  command->add_option("--screenshot", a->screenshot, "Picture of the window's last frame")
      ->type_name("FILE.png")
      ->excludes(headless);
  command->add_flag("--no-shadows", a->no_shadows,
                    "As in `weft render`; the preview never casts shadows");
  command->add_option("--set", a->overrides, "Overrides a key of the scene, e.g. camera.fov=30")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command->callback([a, &session] { preview(*a, session); });
}

}  // namespace weft::cli
