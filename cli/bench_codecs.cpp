// weft bench codecs: what every codec costs and loses on one dataset, and the bars that they are
// held to.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "btf/btf_file.h"
#include "btf/error.h"
#include "cli/bar_report.h"
#include "cli/command.h"
#include "cli/option_checks.h"
#include "cli/scene_folder.h"
#include "study/codec_bars.h"
#include "study/codec_bench.h"
#include "study/dataset_cache.h"
#include "study/machine.h"

namespace weft::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct BenchCodecsOptions {
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
  bool comparisons = true;
  int comparison_texels = 16;
  int comparison_spp = 1024;
};

/// What lobes and SRBF are compared with others on.
constexpr std::array<const char*, 3> compared_structures{"checker", "rings", "tissue"};

/// The registry's rows that were chosen, in its order; all where none was.
std::vector<Codec> chosen_codecs(const BenchCodecsOptions& options) {
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

std::vector<CodecVariant> of_chosen(std::span<const CodecVariant> all,
                                    const std::vector<Codec>& chosen) {
  std::vector<CodecVariant> variants;
  for (const CodecVariant& variant : all) {
    if (std::ranges::count(chosen, variant.codec, &Codec::name) > 0) variants.push_back(variant);
  }
  return variants;
}

fs::path structure_file(const std::string& name, const BenchCodecsOptions& options) {
  return scene_folder(options.scenes) / "mesostructures" / (name + ".toml");
}

fs::path tissue_or_named(const BenchCodecsOptions& options) {
  return options.mesostructure.empty() ? structure_file("tissue", options)
                                       : fs::path(options.mesostructure);
}

/// A dataset to trace.
struct Data {
  fs::path mesostructure;
  std::string directions;
  int texels;  ///< a side of the tile
  int spp;
};

fs::path traced(const Data& data, const Session& session) {
  AcquisitionSettings settings;
  settings.trace.width = settings.trace.height = data.texels;
  settings.trace.spp = data.spp;
  settings.trace.seed = session.seed;
  settings.views = settings.lights = data.directions;
  Progress progress(
      fmt::format("acquire {} {}", data.mesostructure.stem().string(), data.directions),
      session.quiet || session.json);
  return cached_dataset(cache_folder(), read_mesostructure(data.mesostructure), settings, progress);
}

/// @param described  gets what the data are.
std::shared_ptr<const Btf> read_data(const fs::path& folder, Json& described) {
  const auto btf = std::make_shared<const Btf>(read_btf(folder));
  described = {{"folder", folder.string()},
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
               {"luminance_difference", b.luminance_difference},
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
  const auto btf = read_data(data, session.measured["dataset"]);
  say_head("codec", session);
  CodecBenches benches;
  for (const Codec& codec : chosen) {
    benches[codec.name] = bench_one(codec.name, codec, {}, btf, session);
    session.measured["codecs"][codec.name] = json_of(benches[codec.name]);
  }
  return benches;
}

/// @param measured  gets an entry a variant.
CodecBenches bench_variants(const std::vector<CodecVariant>& variants,
                            const std::shared_ptr<const Btf>& btf, Json& measured,
                            const Session& session) {
  CodecBenches benches;
  for (const CodecVariant& variant : variants) {
    benches[variant.name] =
        bench_one(variant.name, codec_named(variant.codec), variant.parameters, btf, session);
    Json& json = measured[variant.name];
    json = {{"codec", variant.codec}, {"parameters", variant.parameters}};
    json.update(json_of(benches[variant.name]));
  }
  return benches;
}

CodecBenches bench_factors(const std::vector<CodecVariant>& variants,
                           const BenchCodecsOptions& options, Session& session) {
  const fs::path data = options.variant_data.empty()
                            ? traced({tissue_or_named(options), options.variant_directions,
                                      options.texels, options.spp},
                                     session)
                            : fs::path(options.variant_data);
  const auto btf = read_data(data, session.measured["variant_dataset"]);
  say_head(fmt::format("\n{} x {} directions", btf->views().size(), btf->lights().size()), session);
  return bench_variants(variants, btf, session.measured["variants"], session);
}

/// Fits that are compared, and what with.
struct ComparedFits {
  const char* name;  ///< in the JSON
  std::vector<CodecVariant> variants;
  int texels;  ///< a side of the tile
  int spp;
};

/// The bars of codecs against each other, on several structures.
std::vector<Bar> bench_comparisons(const ComparedFits& compared, const BenchCodecsOptions& options,
                                   Session& session) {
  std::vector<Bar> bars;
  for (const std::string structure : compared_structures) {
    Json& measured = session.measured["comparisons"][structure][compared.name];
    const auto btf = read_data(traced({structure_file(structure, options), options.directions,
                                       compared.texels, compared.spp},
                                      session),
                               measured["dataset"]);
    say_head(fmt::format("\n{}, {} x {} texels", structure, btf->width(), btf->height()), session);
    const CodecBenches fits = bench_variants(compared.variants, btf, measured["codecs"], session);
    std::ranges::move(comparison_bars(structure, fits), std::back_inserter(bars));
  }
  return bars;
}

void bench_codecs(const BenchCodecsOptions& options, Session& session) {
  const std::vector<Codec> chosen = chosen_codecs(options);
  // All that is named is looked at before any is measured.
  for (const std::string& data : {options.data, options.variant_data}) {
    if (!data.empty()) read_btf_header(data);
  }
  check_elevations(named_directions(options.directions), "direction");
  check_elevations(named_directions(options.variant_directions), "direction");
  if (!options.mesostructure.empty()) read_mesostructure(options.mesostructure);
  std::vector<ComparedFits> comparisons;
  if (options.comparisons) {
    comparisons = {{"models", of_chosen(compared_models(), chosen), options.texels, options.spp},
                   {"kernels", of_chosen(compared_kernels(), chosen), options.comparison_texels,
                    options.comparison_spp}};
    std::erase_if(comparisons, [](const ComparedFits& c) { return c.variants.empty(); });
  }
  for (const std::string structure : compared_structures) {
    if (!comparisons.empty()) read_mesostructure(structure_file(structure, options));
  }

  session.measured["codecs"] = Json::object();  // first in what is printed
  const fs::path data =
      options.data.empty()
          ? traced({tissue_or_named(options), options.directions, options.texels, options.spp},
                   session)
          : fs::path(options.data);
  const CodecBenches codec_benches = bench_registry(chosen, data, session);
  CodecBenches factor_benches;
  const std::vector<CodecVariant> factors = of_chosen(factor_variants(), chosen);
  if (options.variants && !factors.empty())
    factor_benches = bench_factors(factors, options, session);
  std::vector<Bar> bars = codec_bars(codec_benches, factor_benches);
  for (const ComparedFits& compared : comparisons)
    std::ranges::move(bench_comparisons(compared, options, session), std::back_inserter(bars));
  report_bars(bars, session);
  session.measured["processor"] = this_machine().processor;
}

}  // namespace

void add_bench_codecs(CLI::App& bench, Session& session) {
  auto options = std::make_shared<BenchCodecsOptions>();
  CLI::App* codecs = bench.add_subcommand(
      "codecs",
      "Fit every codec with its defaults to one dataset, and measure the fit (seconds, memory over "
      "that of the raw data), decoding on one thread (ns a query, one by one and batched: median "
      "of 301 passes over 1,024 fixed queries), error at the samples and bytes, and with --json "
      "each level of detail's times and error between the samples; then CMF, HF and laplacian by "
      "their parameters, on directions as dense as their paper's, and lobes, PTM and Lafortune "
      "models against each other on checker, rings and tissue, and SRBF by its variables on small "
      "tiles of them. Datasets are traced once and kept in $XDG_CACHE_HOME/weft or ~/.cache/weft");
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
  codecs->add_flag("--comparisons,!--no-comparisons", options->comparisons,
                   "Whether to compare lobes, PTM, Lafortune models and SRBF by its variables (for "
                   "SRBF that takes half an hour); on unless --no-comparisons");
  codecs
      ->add_option("--comparison-texels", options->comparison_texels,
                   "Texels a side of the tiles that SRBF is compared by its variables on")
      ->capture_default_str()
      ->check(whole_number(16384, 1));
  codecs
      ->add_option("--comparison-spp", options->comparison_spp,
                   "Eye paths a view and texel of these tiles: many, since noise is in every fit's "
                   "error alike, and hides how far one is below another")
      ->capture_default_str()
      ->check(whole_number(1 << 20, 1));
  codecs->add_option(
      "--scenes", options->scenes,
      "Folder of scenes; default: $WEFT_SCENES, the installed share/weft/scenes, ./scenes");
  codecs->callback([options, &session] { bench_codecs(*options, session); });
}

}  // namespace weft::cli
