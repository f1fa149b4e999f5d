// weft acquire: traces a mesostructure's BTF into a dataset.
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/acquire.h"
#include "acquisition/offgrid.h"
#include "btf/btf_file.h"
#include "btf/error.h"
#include "cli/command.h"
#include "cli/memory_option.h"
#include "cli/option_checks.h"
#include "cli/run_record.h"

namespace weft::cli {

namespace {

struct AcquireOptions {
  std::string mesostructure;
  std::string output;
  std::string texels = "64";
  std::string directions = "ubo81";
  std::string views;
  std::string lights;
  int spp = 64;
  std::string max_bounces = "8";
  std::string pixel = "half";
  std::string indirect = "traced";
  std::vector<std::string> set;
  double error = 0;
  bool variance = false;
  std::optional<float> alpha;
  int validate = 0;
  std::uint64_t memory = 0;
  std::string shard;
  bool finish = false;
};

/// @param or_else  what may stand there instead, as the message says it.
int whole_number(const std::string& option, const std::string& text, int least, int most,
                 const std::string& or_else = "") {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < least || value > most) {
    throw bad_input(option, fmt::format("is \"{}\"; expected a whole number from {} to {}{}", text,
                                        least, most, or_else));
  }
  return value;
}

int bounces(const std::string& text) {
  if (text == "unlimited") return TraceSettings::unlimited;
  return whole_number("--max-bounces", text, 0, 4096, ", or unlimited");
}

AcquisitionSettings settings_of(const AcquireOptions& options, const Session& session) {
  constexpr int most_texels = 16384;
  AcquisitionSettings settings;
  const std::size_t x = options.texels.find('x');
  settings.trace.width = whole_number("--texels", options.texels.substr(0, x), 1, most_texels);
  settings.trace.height =
      x == std::string::npos
          ? settings.trace.width
          : whole_number("--texels", options.texels.substr(x + 1), 1, most_texels);
  settings.trace.spp = options.spp;
  settings.trace.max_bounces = bounces(options.max_bounces);
  settings.trace.seed = session.seed;
  settings.views = options.views.empty() ? options.directions : options.views;
  settings.lights = options.lights.empty() ? options.directions : options.lights;
  settings.pixel_type = options.pixel == "float" ? PixelType::float32 : PixelType::half;
  if (options.error < 0 || !std::isfinite(options.error))
    throw bad_input("--error", fmt::format("is {}; expected a number above 0", options.error));
  if (options.alpha && !std::isfinite(*options.alpha))
    throw bad_input("--alpha", fmt::format("is {}; expected a height in tiles", *options.alpha));
  settings.trace.error = options.error;
  settings.trace.indirect_cache = options.indirect == "cache";
  settings.trace.texel_errors = options.variance;
  settings.trace.cut_height = options.alpha;
  settings.memory = options.memory;
  return settings;
}

Shard shard_of(const std::string& text) {
  constexpr int most_shards = 1'000'000;
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) {
    throw bad_input("--shard", fmt::format("is \"{}\"; expected I/N, e.g. 0/8, the first of eight "
                                           "shards, to 7/8, the last",
                                           text));
  }
  const int count = whole_number("--shard, N of I/N", text.substr(slash + 1), 1, most_shards);
  const int index =
      whole_number("--shard, I of I/N, counted from 0", text.substr(0, slash), 0, count - 1);
  return {static_cast<std::size_t>(index), static_cast<std::size_t>(count)};
}

void report(const AcquisitionReport& result, const AcquireOptions& options, Session& session) {
  const TraceStatistics& s = result.statistics;
  const auto lights = static_cast<double>(result.lights);
  const double rays_per_second =
      result.seconds > 0 ? static_cast<double>(s.rays()) / result.seconds : 0;
  const double samples_per_second =
      result.seconds > 0 ? static_cast<double>(s.paths) * lights / result.seconds : 0;
  const double missed =
      s.paths > 0 ? 100.0 * static_cast<double>(s.missed) / static_cast<double>(s.paths) : 0;
  session.measured = {{"output", options.output},
                      {"seconds", result.seconds},
                      {"views_kept", result.views_kept},
                      {"paths", s.paths},
                      {"rays", s.rays()},
                      {"primary_rays", s.primary_rays},
                      {"bounce_rays", s.bounce_rays},
                      {"open_bounces", s.open_bounces},
                      {"open_checked", s.open_checked},
                      {"open_wrong", s.open_wrong},
                      {"shadow_rays", s.shadow_rays},
                      {"table_rays", s.table_rays},
                      {"cache_rays", s.cache_rays},
                      {"visibility_queries", s.visibility_queries},
                      {"answers_checked", s.answers_checked},
                      {"wrong_answers", s.wrong_answers},
                      {"negative_means", s.negative},
                      {"rays_traced_on", s.rays_traced_on},
                      {"rays_per_second", rays_per_second},
                      {"samples_per_second", samples_per_second},
                      {"missed_percent", missed},
                      {"degenerate_hits", s.degenerate},
                      {"trapped_paths", s.trapped},
                      {"invalid_samples", s.invalid}};
  if (options.error > 0) {
    const double texels = static_cast<double>(s.texels);
    session.measured["mean_spp"] = texels > 0 ? static_cast<double>(s.paths) / texels : 0;
    session.measured["unsettled_percent"] =
        texels > 0 ? 100 * static_cast<double>(s.unsettled) / texels : 0;
    session.say(
        fmt::format("{:.1f} spp in the mean; {:.2f} % of texels had all {} and stayed above "
                    "the target error",
                    session.measured["mean_spp"].get<double>(),
                    session.measured["unsettled_percent"].get<double>(), options.spp));
  }
  session.say(fmt::format("{}: {:.1f} s, {:.3g} rays/s, {:.3g} samples/s (texel x pair x spp)",
                          options.output, result.seconds, rays_per_second, samples_per_second));
  if (result.views_kept > 0)
    session.say(fmt::format("{} views were there already", result.views_kept));
  if (missed > 0) session.say(fmt::format("{:.2f} % of rays met nothing: add a floor", missed));
  if (s.negative > 0) {
    session.say(
        fmt::format("{} values were left below zero by the correction of a wrong answer of "
                    "the visibility table, and are stored as 0",
                    s.negative));
  }
  if (s.invalid > 0)
    session.say(fmt::format("{} paths ended on a density that is not a number", s.invalid));
  if (s.trapped > 0) session.say(fmt::format("{} paths never left the structure", s.trapped));
  if (s.degenerate > 0) {
    session.say(fmt::format("{} paths ended on triangles without an area", s.degenerate));
  }
}

std::string names_of(const std::vector<std::size_t>& views) {
  constexpr std::size_t most = 8;
  std::string names;
  for (std::size_t i = 0; i < std::min(views.size(), most); ++i) {
    names += (i > 0 ? ", " : "") + view_file_name(views[i]);
  }
  if (views.size() > most) names += fmt::format(" and {} more", views.size() - most);
  return names;
}

void finish(const Mesostructure& mesostructure, const AcquisitionSettings& settings,
            const std::string& output, Session& session) {
  const auto missing = finish_acquisition(mesostructure, settings, output);
  session.measured = {{"output", output}, {"missing_views", missing}};
  if (missing.empty()) {
    session.say(fmt::format("{}: finished", output));
    append_run(std::filesystem::path(output) / "run.json", session);
    return;
  }
  // Told here and not thrown, so that --json still says which.
  fmt::print(stderr,
             "weft: {}: has no {} yet (trace them first, with the same settings; view v is in "
             "--shard I/N with I = v % N)\n",
             output, names_of(missing));
  session.exit_code = failure;
}

void run(const AcquireOptions& options, Session& session) {
  if (options.output.empty())
    throw bad_input("--output", "is empty; expected the folder of a dataset, NAME.btf");
  const AcquisitionSettings settings = settings_of(options, session);
  const bool whole = options.shard.empty();
  const Shard shard = whole ? Shard{} : shard_of(options.shard);
  const Mesostructure mesostructure = read_mesostructure(options.mesostructure, options.set);
  if (options.finish) {
    finish(mesostructure, settings, options.output, session);
    return;
  }
  Progress progress("acquire", session.quiet || session.json);
  report(whole ? acquire(mesostructure, settings, options.output, progress)
               : acquire_shard(mesostructure, settings, shard, options.output, progress),
         options, session);
  if (options.validate > 0) {
    Progress pairs("off-grid pairs", session.quiet || session.json);
    const AcquisitionReport offgrid = acquire_offgrid(
        mesostructure, settings, static_cast<std::size_t>(options.validate), options.output, pairs);
    session.measured["offgrid_pairs"] = options.validate;
    session.measured["offgrid_seconds"] = offgrid.seconds;
    session.say(fmt::format("{}/offgrid: {} pairs, {:.1f} s", options.output, options.validate,
                            offgrid.seconds));
  }
  const std::string record =
      whole ? "run.json" : fmt::format("run_{}of{}.json", shard.index, shard.count);
  append_run(std::filesystem::path(options.output) / record, session);
}

}  // namespace

void add_acquire(CLI::App& app, Session& session) {
  constexpr int most = std::numeric_limits<int>::max();
  auto options = std::make_shared<AcquireOptions>();
  CLI::App* command = app.add_subcommand(
      "acquire",
      "Trace a mesostructure into a raw BTF. An interrupted run continues where it stopped.");
  command->add_option("mesostructure", options->mesostructure, "Mesostructure file (TOML)")
      ->required();
  command->add_option("-o,--output", options->output, "Folder of the dataset, NAME.btf")
      ->required();
  command->add_option("--texels", options->texels, "Texels of the tile: N or WxH")
      ->capture_default_str();
  command
      ->add_option("--directions", options->directions,
                   "Views and lights: ubo81, ubo151, regular:THETAxPHI, fibonacci:N, file:NAME.csv "
                   "(degrees)")
      ->capture_default_str();
  command->add_option("--views", options->views, "Views alone, the same names");
  command->add_option("--lights", options->lights, "Lights alone, the same names");
  command->add_option("--spp", options->spp, "Eye paths a view and texel; each serves every light")
      ->capture_default_str()
      ->check(whole_number(most, 1));
  command
      ->add_option("--max-bounces", options->max_bounces,
                   "Reflections after the first, to 4096: 0 is direct light; or unlimited")
      ->capture_default_str();
  command->add_option("--pixel", options->pixel, "half or float")
      ->capture_default_str()
      ->check(CLI::IsMember({"half", "float"}));
  command
      ->add_option("--indirect", options->indirect,
                   "traced, or cache: for Lambert materials alone; light reflected before comes "
                   "from a cache a cell of the surface and light that all views share: faster, "
                   "and slightly biased")
      ->capture_default_str()
      ->check(CLI::IsMember({"traced", "cache"}));
  command->add_option("--set", options->set,
                      "KEY=VALUE overrides a key of the mesostructure, by its dotted path");
  command->add_option(
      "--error", options->error,
      "Stop a texel of a view, after 16 spp at least, once the root mean square over "
      "lights of its relative standard error is below; --spp is then the most");
  command->add_flag("--variance", options->variance,
                    "Also write the standard error of every value, as parts light_000.error ...");
  command->add_option("--alpha", options->alpha,
                      "Also write coverage, part alpha: the share of a texel's rays that hit at or "
                      "above this height (tiles)");
  CLI::Option* validate =
      command
          ->add_option("--validate", options->validate,
                       "Also trace N random pairs between the directions into OUT/offgrid/; of a "
                       "dataset that is finished already, these alone")
          ->check(whole_number(most));
  add_memory_option(
      *command, options->memory,
      "Most memory, e.g. 4GiB: fewer views are traced at once; 0: as many as threads");
  CLI::Option* shard = command->add_option(
      "--shard", options->shard,
      "I/N, 0 <= I < N: only the views v with v % N = I, and no btf.json; any number of shards may "
      "run at once, on several machines, or again");
  shard->excludes(validate);
  command
      ->add_flag("--finish", options->finish,
                 "Trace nothing: write btf.json once all shards' views are there; exit 1 naming "
                 "those that are not")
      ->excludes(shard)
      ->excludes(validate);
  command->callback([options, &session] { run(*options, session); });
}

}  // namespace weft::cli
