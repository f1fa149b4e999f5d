#include "study/codec_bars.h"

#include <array>

namespace weft {

std::span<const CodecVariant> factor_variants() {
  static const std::array<CodecVariant, 16> variants{{
      {"cmf", "cmf", {}},
      {"cmf float", "cmf", {"bits=float"}},
      {"cmf not turned", "cmf", {"rotate=false"}},
      {"cmf unclustered", "cmf", {"clustered=false"}},
      {"cmf unclustered float", "cmf", {"clustered=false", "bits=float"}},
      {"hf", "hf", {}},
      {"hf unclustered", "hf", {"clustered=false"}},
      {"hf unclustered float", "hf", {"clustered=false", "bits=float"}},
      {"hf lambda 0.1", "hf", {"clustered=false", "lambda=0.1"}},
      {"hf lambda 0.1 float", "hf", {"clustered=false", "bits=float", "lambda=0.1"}},
      {"hf lambda 0.01", "hf", {"clustered=false", "lambda=0.01"}},
      {"hf lambda 0.01 float", "hf", {"clustered=false", "bits=float", "lambda=0.01"}},
      {"hf lambda auto", "hf", {"clustered=false", "lambda=auto"}},
      {"hf lambda auto float", "hf", {"clustered=false", "bits=float", "lambda=auto"}},
      {"laplacian", "laplacian", {}},
      {"laplacian interpolated", "laplacian", {"directions=interpolated"}},
  }};
  return variants;
}

std::span<const CodecVariant> compared_models() {
  static const std::array<CodecVariant, 3> variants{{
      {"lobes", "lobes", {}},
      {"ptm", "ptm", {}},
      {"lafortune", "lafortune", {}},
  }};
  return variants;
}

std::span<const CodecVariant> compared_kernels() {
  // Nearly to the end: where descents stop by default, how fast one gets down counts as much as how
  // far down it leads.
  const auto descended = [](std::vector<std::string> parameters) {
    parameters.insert(parameters.end(), {"iterations=2000", "decrease=1e-4"});
    return parameters;
  };
  static const std::array<CodecVariant, 7> variants{{
      {"srbf optimal", "srbf", descended({})},
      {"srbf half-light-view", "srbf", descended({"modes=half-light-view"})},
      {"srbf half-half-half", "srbf", descended({"modes=half-half-half"})},
      {"srbf half-difference", "srbf", descended({"modes=half-difference"})},
      {"srbf univariate", "srbf", descended({"multivariate=false"})},
      {"srbf default", "srbf", {}},
      {"srbf default float", "srbf", {"bits=float"}},
  }};
  return variants;
}

namespace {

/// A number of one bench against a limit.
struct Limit {
  const char* name;  ///< of the codec or variant
  const char* what;
  const char* unit;
  double (*value)(const CodecBench&);
  double limit;
  bool at_least = false;
};

/// By how much the error of one variant is above that of another.
struct Growth {
  const char* name;
  const char* than;
  const char* what;
  double limit;
};

/// How far the error of one fit is below, or its ratio to, that of another on the same data.
struct Comparison {
  const char* name;
  const char* other;
  const char* what;
  const char* unit;
  double (*value)(const CodecBench& fit, const CodecBench& other);
  double limit;
  bool at_least = false;
};

double percent_below(const CodecBench& fit, const CodecBench& other) {
  return 100 * (1 - fit.rmse / other.rmse);
}
double percent_above(const CodecBench& fit, const CodecBench& other) {
  return -percent_below(fit, other);
}
double of_difference(const CodecBench& fit, const CodecBench& other) {
  return fit.luminance_difference / other.luminance_difference;
}

constexpr std::array<Comparison, 7> comparisons{{
    {"lobes", "ptm", "lobes' luminance difference over PTM's", "times", of_difference, 1},
    {"ptm", "lafortune", "PTM's luminance difference over Lafortune's", "times", of_difference, 1},
    {"srbf optimal", "srbf half-half-half", "srbf: RMSE below (half, half, half)'s", "%",
     percent_below, 30, true},
    {"srbf optimal", "srbf half-difference", "srbf: RMSE below (half, difference)'s", "%",
     percent_below, 30, true},
    {"srbf optimal", "srbf half-light-view", "srbf: RMSE below (half, light, view)'s", "%",
     percent_below, 5, true},
    {"srbf optimal", "srbf univariate", "srbf: RMSE below the univariate form's", "%",
     percent_below, 50, true},
    {"srbf default", "srbf default float", "srbf: RMSE of halfs above floats", "%", percent_above,
     2},
}};
/// Of PTM's difference, where data are as glossy as these.
constexpr double most_of_ptm = 0.5;

double fit_seconds(const CodecBench& bench) {
  return bench.fit_seconds;
}
double decode_ns(const CodecBench& bench) {
  return bench.decode.single;
}
double batched_ns(const CodecBench& bench) {
  return bench.decode.batched;
}
double ratio(const CodecBench& bench) {
  return bench.ratio;
}

constexpr std::array<Limit, 8> codec_limits{{
    {"laplacian", "laplacian: fit", "s", fit_seconds, 30},
    {"raw", "raw: decode", "ns", decode_ns, 150},
    {"cmf", "cmf: decode", "ns", decode_ns, 60},
    {"laplacian", "laplacian: decode", "ns", decode_ns, 150},
    {"lobes", "lobes: fit", "s", fit_seconds, 180},
    {"lobes", "lobes: decode", "ns", decode_ns, 80},
    {"srbf", "srbf: decode, batched", "ns", batched_ns, 120},
    {"srbf", "srbf: 24-bit input over texture bytes", "times", ratio, 30, true},
}};
constexpr std::array<Limit, 2> variant_limits{{
    {"cmf", "cmf: fit with clustering, dense directions", "s", fit_seconds, 20},
    {"hf", "hf: fit with clustering, dense directions", "s", fit_seconds, 60},
}};
constexpr std::array<Growth, 4> growths{{
    {"cmf", "cmf float", "cmf: RMSE of 8 bits above floats, clustered", 5},
    {"cmf unclustered", "cmf unclustered float", "cmf: RMSE of 8 bits above floats, unclustered",
     5},
    {"cmf", "cmf unclustered", "cmf: RMSE of 256 clusters a factor above none", 12},
    {"hf", "hf unclustered", "hf: RMSE of 256 clusters a factor above none", 12},
}};
/// Of a fit by SRBF of up to 64 x 64 texels, and of larger ones.
constexpr std::size_t small_tile = std::size_t{64} * 64;
constexpr double srbf_seconds = 15 * 60;
constexpr double srbf_seconds_of_large_tiles = 60 * 60;
constexpr double least_gain_of_batches = 2;
constexpr double most_memory = 3;

void add_limits(std::span<const Limit> limits, const CodecBenches& benches,
                std::vector<Bar>& bars) {
  for (const Limit& limit : limits) {
    const auto found = benches.find(limit.name);
    if (found == benches.end()) continue;
    bars.push_back(
        {limit.what, limit.unit, limit.value(found->second), limit.limit, limit.at_least});
  }
}

void add_memory(const CodecBenches& benches, const std::string& dataset, std::vector<Bar>& bars) {
  for (const auto& [name, bench] : benches) {
    if (!bench.fit_memory) continue;
    bars.push_back({name + ": memory of the fit over the raw data" + dataset, "times",
                    *bench.fit_memory, most_memory});
  }
}

}  // namespace

std::vector<Bar> codec_bars(const CodecBenches& codecs, const CodecBenches& variants) {
  std::vector<Bar> bars;
  add_limits(codec_limits, codecs, bars);
  if (const auto srbf = codecs.find("srbf"); srbf != codecs.end()) {
    const bool is_small = srbf->second.texels <= small_tile;
    bars.push_back({"srbf: fit", "s", srbf->second.fit_seconds,
                    is_small ? srbf_seconds : srbf_seconds_of_large_tiles});
  }
  for (const auto& [name, bench] : codecs) {
    bars.push_back({name + ": decode one by one over batched", "times",
                    bench.decode.single / bench.decode.batched, least_gain_of_batches, true});
  }
  add_limits(variant_limits, variants, bars);
  for (const Growth& growth : growths) {
    const auto more = variants.find(growth.name);
    const auto less = variants.find(growth.than);
    if (more == variants.end() || less == variants.end() || !(less->second.rmse > 0)) continue;
    bars.push_back(
        {growth.what, "%", 100 * (more->second.rmse / less->second.rmse - 1), growth.limit});
  }
  add_memory(codecs, "", bars);
  add_memory(variants, ", dense directions", bars);
  return bars;
}

std::vector<Bar> comparison_bars(const std::string& structure, const CodecBenches& fits) {
  std::vector<Bar> bars;
  for (const Comparison& comparison : comparisons) {
    const auto fit = fits.find(comparison.name);
    const auto other = fits.find(comparison.other);
    if (fit == fits.end() || other == fits.end()) continue;
    if (!(other->second.rmse > 0 && other->second.luminance_difference > 0)) continue;
    const bool is_of_lobes = fit->first == "lobes";
    const double limit = is_of_lobes && (structure == "checker" || structure == "rings")
                             ? most_of_ptm
                             : comparison.limit;
    bars.push_back({structure + ", " + comparison.what, comparison.unit,
                    comparison.value(fit->second, other->second), limit, comparison.at_least});
  }
  return bars;
}

}  // namespace weft
