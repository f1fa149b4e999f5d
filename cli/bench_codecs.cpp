// weft bench codecs: what every codec costs and loses on one dataset, and the bars that they are
// held to.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "btf/btf_file.h"
#include "btf/error.h"
#include "cli/command.h"
#include "cli/option_checks.h"
#include "cli/scene_folder.h"
#include "study/codec_bars.h"
#include "study/codec_bench.h"
#include "study/dataset_cache.h"

namespace weft::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Options {
  std::vector<std::string> codecs;
  std::string data;
  std::string mesostructure;
  std::string scenes;
  int texels = 64;
  int spp = 64;
  std::string directions = "ubo81";
  bool variants = true;
  std::string variant_data;
  std::string variant_directions = "regular:16x8";
};

/// The registry's rows that were chosen, in its order; all where none was.
std::vector<Codec> chosen_codecs(const Options& options) {
  for (const std::string& name : options.codecs) {
    codec_named(name);
    if (std::ranges::count(options.codecs, name) > 1)
      throw bad_input("--codec", fmt::format("names '{}' twice", name));
  }
  std::vector<Codec> chosen;
  for (const Codec& codec : codecs()) {
    if (options.codecs.empty() || std::ranges::count(options.codecs, codec.name) > 0)
      chosen.push_back(codec);
  }
  return chosen;
}

std::vector<CodecVariant> chosen_variants(const Options& options,
                                          const std::vector<Codec>& chosen) {
  std::vector<CodecVariant> variants;
  for (const CodecVariant& variant : factor_variants()) {
    if (options.variants && std::ranges::count(chosen, variant.codec, &Codec::name) > 0)
      variants.push_back(variant);
  }
  return variants;
}

fs::path traced(const Options& options, const std::string& directions, const Session& session) {
  const fs::path file = options.mesostructure.empty()
                            ? scene_folder(options.scenes) / "mesostructures" / "tissue.toml"
                            : fs::path(options.mesostructure);
  AcquisitionSettings settings;
  settings.trace.width = settings.trace.height = options.texels;
  settings.trace.spp = options.spp;
  settings.trace.seed = session.seed;
  settings.views = settings.lights = directions;
  Progress progress("acquire " + directions, session.quiet || session.json);
  return cached_dataset(cache_folder(), read_mesostructure(file), settings, progress);
}

std::shared_ptr<const Btf> read_data(const fs::path& folder, const std::string& key,
                                     Session& session) {
  const auto btf = std::make_shared<const Btf>(read_btf(folder));
  session.measured[key] = {{"folder", folder.string()},
                           {"texels", {btf->width(), btf->height()}},
                           {"views", btf->views().size()},
                           {"lights", btf->lights().size()},
                           {"bytes", btf->bytes()}};
  return btf;
}

Json json_of(const CodecBench& b) {
  Json json = {{"fit_seconds", b.fit_seconds},
               {"decode_ns", b.decode.single},
               {"decode_batched_ns", b.decode.batched},
               {"rmse", b.rmse},
               {"relative_rmse", b.relative_rmse},
               {"bytes", b.bytes},
               {"constant_bytes", b.constant_bytes},
               {"ratio", b.ratio},
               {"fit_memory", nullptr},
               {"levels", Json::array()}};
  if (b.fit_memory) json["fit_memory"] = *b.fit_memory;
  for (const LevelBench& level : b.levels) {
    json["levels"].push_back({{"lod", level.lod},
                              {"decode_ns", level.decode.single},
                              {"decode_batched_ns", level.decode.batched},
                              {"relative_rmse", level.relative_rmse}});
  }
  return json;
}

void say_head(const std::string& first, const Session& session) {
  session.say(fmt::format("{:24} {:>8} {:>8} {:>9} {:>8} {:>11} {:>7} {:>7}", first, "fit s", "ns",
                          "ns batch", "RMSE %", "bytes", "ratio", "memory"));
}

void say_row(const std::string& name, const CodecBench& b, const Session& session) {
  session.say(fmt::format("{:24} {:8.2f} {:8.1f} {:9.1f} {:8.2f} {:11} {:7.1f} {:>7}", name,
                          b.fit_seconds, b.decode.single, b.decode.batched, 100 * b.relative_rmse,
                          b.bytes, b.ratio,
                          b.fit_memory ? fmt::format("{:.2f}", *b.fit_memory) : "?"));
}

CodecBench bench_one(const std::string& name, const Codec& codec,
                     const std::vector<std::string>& parameters,
                     const std::shared_ptr<const Btf>& btf, const Session& session) {
  Progress progress(name, session.quiet || session.json);
  const CodecBench bench = bench_codec(codec, parameters, btf, progress);
  say_row(name, bench, session);
  return bench;
}

CodecBenches bench_registry(const std::vector<Codec>& chosen, const fs::path& data,
                            Session& session) {
  const auto btf = read_data(data, "dataset", session);
  say_head("codec", session);
  CodecBenches benches;
  for (const Codec& codec : chosen) {
    benches[codec.name] = bench_one(codec.name, codec, {}, btf, session);
    session.measured["codecs"][codec.name] = json_of(benches[codec.name]);
  }
  return benches;
}

CodecBenches bench_variants(const std::vector<CodecVariant>& variants, const fs::path& data,
                            Session& session) {
  const auto btf = read_data(data, "variant_dataset", session);
  say_head(fmt::format("\n{} x {} directions", btf->views().size(), btf->lights().size()), session);
  CodecBenches benches;
  for (const CodecVariant& variant : variants) {
    benches[variant.name] =
        bench_one(variant.name, codec_named(variant.codec), variant.parameters, btf, session);
    Json& json = session.measured["variants"][variant.name];
    json = {{"codec", variant.codec}, {"parameters", variant.parameters}};
    json.update(json_of(benches[variant.name]));
  }
  return benches;
}

void report_bars(const std::vector<Bar>& bars, Session& session) {
  session.measured["bars"] = Json::array();
  session.say("");
  for (const Bar& bar : bars) {
    session.measured["bars"].push_back({{"what", bar.what},
                                        {"value", bar.value},
                                        {bar.at_least ? "at_least" : "below", bar.limit},
                                        {"unit", bar.unit},
                                        {"met", bar.met()}});
    session.say(fmt::format("{}  {:70} {:8.2f} {} ({} {:g})", bar.met() ? "met   " : "MISSED",
                            bar.what, bar.value, bar.unit, bar.at_least ? "at least" : "below",
                            bar.limit));
  }
}

void bench_codecs(const Options& options, Session& session) {
  const std::vector<Codec> chosen = chosen_codecs(options);
  const std::vector<CodecVariant> variants = chosen_variants(options, chosen);
  // All that is named is looked at before any is measured.
  for (const std::string& data : {options.data, options.variant_data}) {
    if (!data.empty()) read_btf_header(data);
  }
  check_elevations(named_directions(options.directions), "direction");
  check_elevations(named_directions(options.variant_directions), "direction");

  session.measured["codecs"] = Json::object();  // first in what is printed
  const fs::path data =
      options.data.empty() ? traced(options, options.directions, session) : fs::path(options.data);
  const CodecBenches codec_benches = bench_registry(chosen, data, session);
  CodecBenches variant_benches;
  if (!variants.empty()) {
    const fs::path folder = options.variant_data.empty()
                                ? traced(options, options.variant_directions, session)
                                : fs::path(options.variant_data);
    variant_benches = bench_variants(variants, folder, session);
  }
  report_bars(codec_bars(codec_benches, variant_benches), session);
}

}  // namespace

void add_bench_codecs(CLI::App& bench, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* codecs = bench.add_subcommand(
      "codecs",
      "Fit every codec with its defaults to one dataset, and measure the fit (seconds, memory over "
      "that of the raw data), decoding on one thread (ns a query, one by one and batched: median "
      "of 301 passes over 1,024 fixed queries), error at the samples and bytes, and with --json "
      "each level of detail's times and error between the samples; then CMF, HF and laplacian by "
      "their parameters, on directions as dense as their paper's. Datasets are traced once and "
      "kept in $XDG_CACHE_HOME/weft or ~/.cache/weft");
  codecs
      ->add_option("--codec", options->codecs,
                   "Only this one, and its variants; may be repeated. Default: all")
      ->allow_extra_args(false);
  codecs->add_option("--data", options->data, "Raw BTF to measure on, in place of a traced one");
  codecs->add_option("--mesostructure", options->mesostructure,
                     "Mesostructure file to trace; default: tissue.toml");
  codecs->add_option("--texels", options->texels, "Texels a side of the tile")
      ->capture_default_str()
      ->check(whole_number(16384, 1));
  codecs->add_option("--spp", options->spp, "Eye paths a view and texel")
      ->capture_default_str()
      ->check(whole_number(1 << 20, 1));
  codecs->add_option("--directions", options->directions, "Views and lights, as in acquire")
      ->capture_default_str();
  codecs->add_flag(
      "--variants,!--no-variants", options->variants,
      "Whether to measure CMF, HF and laplacian by their parameters; on unless --no-variants");
  codecs->add_option("--variant-data", options->variant_data,
                     "Raw BTF to measure the variants on, in place of a traced one");
  codecs
      ->add_option("--variant-directions", options->variant_directions,
                   "Views and lights of the variants' dataset")
      ->capture_default_str();
  codecs->add_option(
      "--scenes", options->scenes,
      "Folder of scenes; default: $WEFT_SCENES, the installed share/weft/scenes, ./scenes");
  codecs->callback([options, &session] { bench_codecs(*options, session); });
}

}  // namespace weft::cli
