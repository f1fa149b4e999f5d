// weft bench acquire: how fast datasets are traced.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "btf/error.h"
#include "cli/bar_report.h"
#include "cli/command.h"
#include "cli/option_checks.h"
#include "cli/scene_folder.h"
#include "settings/nearest_name.h"
#include "study/acquisition_bench.h"
#include "study/machine.h"

namespace weft::cli {

namespace {

namespace fs = std::filesystem;

struct Structure {
  std::string name;  // in the report
  std::string file;  // below scenes/mesostructures
  std::vector<std::string> overrides;
};

const std::vector<Structure> structures = {
    {"checker", "checker_lambert.toml", {}},
    {"checker_128", "checker_lambert.toml", {"resolution=128"}},  // quads a side; else 256
    {"checker_glossy", "checker.toml", {}},
    {"rings", "rings.toml", {}},
    {"tissue", "tissue.toml", {}}};

std::vector<std::string> names_of_structures() {
  std::vector<std::string> names;
  names.reserve(structures.size());
  for (const Structure& structure : structures) names.push_back(structure.name);
  return names;
}

struct BenchAcquireOptions {
  std::string structures = fmt::format("{}", fmt::join(names_of_structures(), ","));
  std::string scenes;
  int texels = 64;
  int spp = 64;
  std::string directions = "ubo81";
};

nlohmann::ordered_json json_of(const AcquisitionBench& b) {
  const TraceStatistics& s = b.statistics;
  nlohmann::ordered_json json = {{"roofline_ratio", b.roofline_ratio},
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
                                 {"rays_traced_on", s.rays_traced_on},
                                 {"bounce_rays", s.bounce_rays},
                                 {"open_bounces", s.open_bounces},
                                 {"open_checked", s.open_checked},
                                 {"open_wrong", s.open_wrong},
                                 {"negative_means", s.negative},
                                 {"rmse", b.rmse},
                                 {"naive_rmse", b.naive_rmse},
                                 {"naive_spp", naive_bench_spp},
                                 {"naive_seconds_a_pair", b.naive_seconds_a_pair}};
  if (b.indirect_cache) {
    json["indirect_cache"] = {{"full_dataset_seconds", b.indirect_cache->full_dataset_seconds},
                              {"samples_per_second", b.indirect_cache->samples_per_second},
                              {"bias", b.indirect_cache->bias},
                              {"rms_difference", b.indirect_cache->rms_difference},
                              {"standard_error", b.indirect_cache->standard_error}};
  }
  return json;
}

const Structure& structure_named(const std::string& name) {
  for (const Structure& structure : structures) {
    if (structure.name == name) return structure;
  }
  throw bad_input("--structures", fmt::format("there is no structure '{}'", name),
                  name_hint(name, names_of_structures()));
}

/// The structures of a list "a,b,...", read before any is measured.
std::vector<std::pair<std::string, Mesostructure>> read_structures(const std::string& list,
                                                                   const fs::path& folder) {
  std::vector<std::pair<std::string, Mesostructure>> result;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string name = list.substr(begin, end - begin);
    const Structure& structure = structure_named(name);
    for (const auto& [earlier, mesostructure] : result) {
      if (earlier == name) throw bad_input("--structures", fmt::format("names '{}' twice", name));
    }
    result.emplace_back(name, read_mesostructure(folder / structure.file, structure.overrides));
    begin = end + 1;
  }
  return result;
}

void bench_acquire(const BenchAcquireOptions& options, Session& session) {
  const fs::path folder = scene_folder(options.scenes) / "mesostructures";
  AcquisitionSettings settings;
  settings.trace.width = settings.trace.height = options.texels;
  settings.trace.spp = options.spp;
  settings.trace.seed = session.seed;
  settings.views = settings.lights = options.directions;
  check_elevations(named_directions(options.directions), "direction");
  const auto chosen = read_structures(options.structures, folder);
  session.say(fmt::format("{:15} {:>9} {:>12} {:>12} {:>9} {:>9} {:>9}", "", "seconds", "samples/s",
                          "rays/s", "roofline", "speedup", "RMSE"));
  std::vector<Bar> bars;
  const fs::path dataset = fs::temp_directory_path() / fmt::format("weft_bench_{}.btf", getpid());
  for (const auto& [name, mesostructure] : chosen) {
    Progress progress(name, session.quiet || session.json);
    const AcquisitionBench b = bench_acquisition(name, mesostructure, settings, dataset, progress);
    session.measured["structures"][name] = json_of(b);
    std::ranges::move(acquisition_bars(b), std::back_inserter(bars));
    session.say(fmt::format("{:15} {:9.2f} {:12.4g} {:12.4g} {:9.2f} {:9.1f} {:9.3g}", name,
                            b.full_dataset_seconds, b.samples_per_second, b.rays_per_second,
                            b.roofline_ratio, b.speedup_equal_rmse, b.rmse));
    if (const auto& c = b.indirect_cache) {
      session.say(
          fmt::format("{:>15} {:9.2f} {:12.4g}   the tile's mean is off by {:.3f} % in the "
                      "mean, {:.3f} % RMS (noise {:.3f} %)",
                      "indirect cache", c->full_dataset_seconds, c->samples_per_second,
                      100 * c->bias, 100 * c->rms_difference, 100 * c->standard_error));
    }
  }
  Progress progress("costs", session.quiet || session.json);
  const std::vector<AcquisitionCost> costs =
      acquisition_costs(chosen.front().second, settings, dataset, progress);
  for (const AcquisitionCost& cost : costs) {
    session.measured["costs"][cost.size].push_back(
        {{"factor", cost.factor}, {"seconds", cost.seconds}});
    session.say(fmt::format("{:8} x {}: {:.3f} s", cost.size, cost.factor, cost.seconds));
  }
  std::ranges::move(cost_bars(costs), std::back_inserter(bars));
  report_bars(bars, session);
  const Machine machine = this_machine();
  session.measured["processor"] = machine.processor;
  session.measured["cores"] = machine.cores;
  session.measured["texels"] = options.texels;
  session.measured["spp"] = options.spp;
  session.measured["directions"] = options.directions;
  session.measured["max_bounces"] = settings.trace.max_bounces;
}

}  // namespace

void add_bench_acquire(CLI::App& bench, Session& session) {
  auto options = std::make_shared<BenchAcquireOptions>();
  CLI::App* acquire = bench.add_subcommand("acquire",
                                           "Trace and write whole datasets (8 bounces), and hold "
                                           "the time against what Embree alone needs "
                                           "for the same queries and against the plain way at "
                                           "equal error; then how time grows with each "
                                           "size");
  acquire
      ->add_option("--structures", options->structures,
                   "Which to measure, separated by commas; checker is the Lambert one, "
                   "checker_128 the same of 128 x 128 quads")
      ->capture_default_str();
  acquire->add_option("--texels", options->texels, "Texels a side of the tile")
      ->capture_default_str()
      ->check(whole_number(16384, 1));
  acquire->add_option("--spp", options->spp, "Eye paths a view and texel")
      ->capture_default_str()
      ->check(whole_number(1 << 20, 2));
  acquire->add_option("--directions", options->directions, "Views and lights, as in acquire")
      ->capture_default_str();
  acquire->add_option(
      "--scenes", options->scenes,
      "Folder of scenes; default: $WEFT_SCENES, the installed share/weft/scenes, ./scenes");
  acquire->callback([options, &session] { bench_acquire(*options, session); });
}

}  // namespace weft::cli
