// weft demo: the main job on three BTFs, from mesostructure to a page of pictures and numbers.

#include <fmt/core.h>

#include <array>
#include <chrono>
#include <memory>
#include <vector>

#include "btf/atomic_file.h"
#include "btf/error.h"
#include "cli/command.h"
#include "cli/demo_job.h"
#include "cli/demo_report.h"
#include "cli/scene_folder.h"
#include "codecs/representation.h"
#include "study/machine.h"

namespace weft::cli {

namespace {

const std::array<DemoItem, 3>& demo_items() {
  static const std::array<DemoItem, 3> items{{{"checker", "cube", "cube_checker.toml"},
                                              {"rings", "seashell", "seashell_rings.toml"},
                                              {"tissue", "torus", "torus_tissue.toml"}}};
  return items;
}

nlohmann::ordered_json described(const DemoSettings& s) {
  return {{"texels", s.texels},
          {"directions", s.directions},
          {"spp", s.spp},
          {"max_bounces", s.max_bounces},
          {"codec", s.codec},
          {"picture_size", s.picture_size},
          {"picture_spp", s.picture_spp},
          {"frames", s.frames},
          {"seed", s.seed}};
}

std::string summary(const DemoResult& r) {
  return fmt::format(
      "{:<8} on a {:<9} traced in {:.1f} s{}, {} fitted in {:.1f} s, {:.0f} : 1; RMSE {:.2f} % "
      "(path tracer), {:.2f} % "
      "(preview)",
      r.item.name, r.item.shape, r.raw.seconds, r.kept ? " (kept)" : "", r.compressed.codec,
      r.compressed.seconds, r.compressed.ratio, 100 * r.traced.relative_rmse,
      100 * r.previewed.relative_rmse);
}

/// A mistyped name is told before minutes of tracing, and so is `raw`: the demo compares with it.
void check_codec(const std::string& name) {
  if (codec_named(name).name != "raw") return;
  std::string others;
  for (const Codec& codec : codecs()) {
    if (codec.name != "raw") others += (others.empty() ? "" : ", ") + codec.name;
  }
  throw bad_input("--codec",
                  "the demo compares a compressed BTF with raw, and raw is not compressed",
                  "valid here: " + others);
}

void demo(DemoSettings settings, Session& session) {
  check_codec(settings.codec);
  settings.scenes = scene_folder(settings.scenes);
  settings.seed = session.seed;
  settings.quiet = session.quiet;
  const Machine machine = this_machine();
  const int threads = session.threads > 0 ? session.threads : machine.cores;
  session.measured["machine"] = {
      {"processor", machine.processor}, {"threads", threads}, {"system", machine.system}};
  session.measured["settings"] = described(settings);

  const auto begin = std::chrono::steady_clock::now();
  std::vector<DemoResult> results;
  for (const DemoItem& item : demo_items()) {
    results.push_back(run_demo_item(item, settings));
    session.measured["btfs"][item.name] = measured_of(results.back());
    session.say(summary(results.back()));
  }
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  session.measured["seconds"] = seconds;

  const std::string footer =
      fmt::format("{}, {} threads, {}; preview on {}. {:.0f} s in all.", machine.processor, threads,
                  machine.system, results.front().raw.previewed.renderer, seconds);
  const std::filesystem::path page =
      write_report(settings.folder, demo_report(results, settings, footer));
  write_text_atomically(settings.folder / "demo.json", session.measured.dump(2) + "\n");
  session.say(fmt::format("{:.0f} s; open {}", seconds, page.string()));
}

}  // namespace

void add_demo(CLI::App& app, Session& session) {
  CLI::App* command = app.add_subcommand("demo",
                                         "Trace the checker, rings and tissue BTFs, compress them, "
                                         "render them raw and compressed in the path tracer and "
                                         "the preview, and write a page of pictures, error maps "
                                         "and numbers. What an earlier run finished is kept");
  auto s = std::make_shared<DemoSettings>();
  command->add_option("-o,--output", s->folder, "Folder of index.html, demo.json and data/")
      ->capture_default_str();
  command->add_option("--texels", s->texels, "Columns and rows of a tile, in texels")
      ->capture_default_str()
      ->check(CLI::Range(1, 4096));
  command
      ->add_option("--directions", s->directions,
                   "Views and lights: ubo81, ubo151, regular:TxP, fibonacci:N, ...")
      ->capture_default_str();
  command->add_option("--spp", s->spp, "Eye paths a (view, texel)")
      ->capture_default_str()
      ->check(CLI::Range(1, 1 << 20));
  command
      ->add_option("--max-bounces", s->max_bounces,
                   "Reflections after the first, in acquisition and path tracer; 0 is direct light")
      ->capture_default_str()
      ->check(CLI::Range(0, 1 << 20));
  command->add_option("--codec", s->codec, "How to compress")->capture_default_str();
  command->add_option("--size", s->picture_size, "Columns and rows of a picture, in pixels")
      ->capture_default_str()
      ->check(CLI::Range(16, 8192));
  command->add_option("--picture-spp", s->picture_spp, "Path tracer's samples a pixel")
      ->capture_default_str()
      ->check(CLI::Range(1, 1 << 20));
  command->add_option("--frames", s->frames, "Frames timed in the preview")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  command->add_option(
      "--scenes", s->scenes,
      "Folder of scenes; default: $WEFT_SCENES, the installed share/weft/scenes, ./scenes");
  command->callback([s, &session] { demo(*s, session); });
}

}  // namespace weft::cli
