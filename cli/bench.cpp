// weft bench: how fast the parts are.
#include <fmt/core.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "btf/error.h"
#include "cli/command.h"
#include "cli/option_checks.h"
#include "cli/scene_folder.h"
#include "study/acquisition_bench.h"

namespace weft::cli {

namespace {

namespace fs = std::filesystem;

// Names in the report, and their files below scenes/mesostructures.
const std::vector<std::pair<std::string, std::string>> structures = {
    {"checker", "checker_lambert.toml"},
    {"checker_glossy", "checker.toml"},
    {"rings", "rings.toml"},
    {"tissue", "tissue.toml"}};

struct Options {
  std::vector<std::string> structures;
  std::string scenes;
  int texels = 64;
  int spp = 64;
  std::string directions = "ubo81";
};

nlohmann::ordered_json json_of(const AcquisitionBench& b) {
  const TraceStatistics& s = b.statistics;
  return {{"roofline_ratio", b.roofline_ratio},
          {"speedup_equal_rmse", b.speedup_equal_rmse},
          {"full_dataset_seconds", b.full_dataset_seconds},
          {"samples_per_second", b.samples_per_second},
          {"rays_per_second", b.rays_per_second},
          {"embree_seconds", b.embree_seconds},
          {"embree_forms",
           {{"primary", b.primary_form},
            {"bounce", b.bounce_form},
            {"first_shadow", b.first_shadow_form},
            {"later_shadow", b.later_shadow_form}}},
          {"visibility_queries", s.visibility_queries},
          {"shadow_rays", s.shadow_rays},
          {"table_rays", s.table_rays},
          {"answers_checked", s.answers_checked},
          {"wrong_answers", s.wrong_answers},
          {"negative_means", s.negative},
          {"rmse", b.rmse},
          {"naive_rmse", b.naive_rmse},
          {"naive_spp", naive_bench_spp},
          {"naive_seconds_a_pair", b.naive_seconds_a_pair}};
}

std::string file_of(const std::string& name) {
  for (const auto& [known, file] : structures) {
    if (known == name) return file;
  }
  throw bad_input("--structures", fmt::format("names \"{}\"; expected checker, checker_glossy, "
                                              "rings or tissue",
                                              name));
}

void bench_acquire(const Options& options, Session& session) {
  const fs::path folder = scene_folder(options.scenes) / "mesostructures";
  AcquisitionSettings settings;
  settings.trace.width = settings.trace.height = options.texels;
  settings.trace.spp = options.spp;
  settings.trace.seed = session.seed;
  settings.views = settings.lights = options.directions;
  std::vector<std::string> names = options.structures;
  if (names.empty()) {
    for (const auto& [name, file] : structures) names.push_back(name);
  }
  session.say(fmt::format("{:15} {:>9} {:>12} {:>12} {:>9} {:>9} {:>9}", "", "seconds", "samples/s",
                          "rays/s", "roofline", "speedup", "RMSE"));
  for (const std::string& name : names) {
    const Mesostructure mesostructure = read_mesostructure(folder / file_of(name));
    Progress progress(name, session.quiet || session.json);
    const fs::path dataset = fs::temp_directory_path() / fmt::format("weft_bench_{}.btf", getpid());
    const AcquisitionBench b = bench_acquisition(name, mesostructure, settings, dataset, progress);
    session.measured["structures"][name] = json_of(b);
    session.say(fmt::format("{:15} {:9.2f} {:12.4g} {:12.4g} {:9.2f} {:9.1f} {:9.3g}", name,
                            b.full_dataset_seconds, b.samples_per_second, b.rays_per_second,
                            b.roofline_ratio, b.speedup_equal_rmse, b.rmse));
  }
  const Mesostructure first = read_mesostructure(folder / file_of(names.front()));
  for (const AcquisitionCost& cost : acquisition_costs(first, settings)) {
    session.measured["costs"][cost.size].push_back(
        {{"factor", cost.factor}, {"seconds", cost.seconds}});
    session.say(fmt::format("{:8} x {}: {:.3f} s", cost.size, cost.factor, cost.seconds));
  }
  session.measured["texels"] = options.texels;
  session.measured["spp"] = options.spp;
  session.measured["directions"] = options.directions;
  session.measured["max_bounces"] = settings.trace.max_bounces;
}

}  // namespace

void add_bench(CLI::App& app, Session& session) {
  CLI::App* bench = app.add_subcommand("bench", "Measure how fast the parts are");
  bench->require_subcommand(1);
  auto options = std::make_shared<Options>();
  CLI::App* acquire = bench->add_subcommand("acquire",
                                            "Trace and write whole datasets (8 bounces), and hold "
                                            "the time against what Embree alone needs "
                                            "for the same queries and against the plain way at "
                                            "equal error; then how time grows with each "
                                            "size");
  acquire
      ->add_option("--structures", options->structures,
                   "checker (Lambert), checker_glossy, rings, tissue; default: all")
      ->delimiter(',');
  acquire->add_option("--texels", options->texels, "Texels a side of the tile")
      ->capture_default_str()
      ->check(at_least(1));
  acquire->add_option("--spp", options->spp, "Eye paths a view and texel")
      ->capture_default_str()
      ->check(at_least(2));
  acquire->add_option("--directions", options->directions, "Views and lights, as in acquire")
      ->capture_default_str();
  acquire->add_option(
      "--scenes", options->scenes,
      "Folder of scenes; default: $WEFT_SCENES, the installed share/weft/scenes, ./scenes");
  acquire->callback([options, &session] { bench_acquire(*options, session); });
}

}  // namespace weft::cli
