#include "codecs/srbf/fit.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "codecs/fit_checkpoint.h"
#include "codecs/sample_check.h"
#include "codecs/srbf/level_fit.h"

namespace weft::srbf {

namespace {

using Json = nlohmann::ordered_json;

// Raised when a fit makes something else of the same data.
constexpr int fit_version = 4;

// The parameters that a checkpoint is known by: rounding and filtering come after the fit, so that
// what is kept serves any.
std::string fit_parameters(FitOptions options) {
  options.storage = Storage::float32;
  options.filtering = Filtering::values;
  return to_json(options);
}

// Of black data, so that nothing is divided by 0.
constexpr double smallest_scale = 1e-30;

// Mean square of a level's data.
double mean_square(const MipLevels& data, const Samples& samples, int level) {
  std::vector<double> sums(data.sizes().texels(level));
  double count = 0;
  for (const float gain : samples.gain) count += gain > 0 ? 3 : 0;
  tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t texel) {
    std::vector<float> abrdf(3 * samples.pairs);
    data.abrdf(level, texel, abrdf);
    for (std::size_t i = 0; i < abrdf.size(); ++i) {
      if (samples.gain[i / 3] > 0) sums[texel] += static_cast<double>(abrdf[i]) * abrdf[i];
    }
  });
  double sum = 0;
  for (const double texel : sums) sum += texel;
  return count > 0 ? sum / (count * static_cast<double>(sums.size())) : 0;
}

Json level_report(int level, const LevelResult& result, double scale, double square) {
  const double error = std::sqrt(result.squared_error) * scale;
  return {{"level", level},
          {"texels", result.kernels.size()},
          {"rmse", error},
          {"relative_rmse", square > 0 ? error / std::sqrt(square) : 0.0},
          {"fallbacks", result.fallbacks},
          {"restarts", result.restarts}};
}

// A level as doubles: of each texel its numbers, then what the level tells of itself.
std::vector<double> packed(const LevelResult& result) {
  std::vector<double> values;
  values.reserve(result.kernels.size() * result.kernels.front().values().size() + 3);
  for (const Kernels& kernels : result.kernels)
    values.insert(values.end(), kernels.values().begin(), kernels.values().end());
  values.insert(values.end(), {result.squared_error, static_cast<double>(result.fallbacks),
                               static_cast<double>(result.restarts)});
  return values;
}

LevelResult unpacked(const std::vector<double>& values, const Shape& shape) {
  LevelResult result;
  auto at = values.begin();
  while (values.end() - at >= static_cast<std::ptrdiff_t>(shape.numbers())) {
    Kernels kernels(shape);
    std::copy_n(at, shape.numbers(), kernels.values().begin());
    at += static_cast<std::ptrdiff_t>(shape.numbers());
    result.kernels.push_back(std::move(kernels));
  }
  result.squared_error = at[0];
  result.fallbacks = static_cast<std::size_t>(at[1]);
  result.restarts = static_cast<std::size_t>(at[2]);
  return result;
}

// The level as an earlier run left it, or fitted now.
LevelResult kept_or_fitted(const FitCheckpoint& checkpoint, const std::string& name,
                           const Shape& shape, std::size_t texels,
                           const std::function<LevelResult()>& fitted) {
  if (const auto kept = checkpoint.find(name, texels * shape.numbers() + 3))
    return unpacked(*kept, shape);
  LevelResult result = fitted();
  checkpoint.keep(name, packed(result));
  return result;
}

}  // namespace

Model fit(const Btf& btf, const FitOptions& options, Progress& progress) {
  refuse_invalid_samples(btf);
  Model model{.head = fitted_head(btf, to_json(options))};
  model.storage = options.storage;
  model.shape = {options.kernels, options.modes.angles.size()};
  model.quantity = options.quantity;
  model.filtering = options.filtering;
  const FitCheckpoint checkpoint =
      FitCheckpoint::of_fit(progress.kept_in(), btf, "srbf", fit_version, fit_parameters(options));
  const Samples samples(btf.views(), btf.lights(), options.quantity);
  const MipLevels data(btf);
  const MipSizes& sizes = data.sizes();
  const double scale = std::max(std::sqrt(mean_square(data, samples, 0)), smallest_scale);

  Json levels = Json::array();
  std::vector<Kernels> kernels;  // level 0 first
  std::vector<Kernels> parents;
  // Levels of the modes that the angles begin with, as a fit by these alone has them: free angles
  // start from these, too, so that they end no worse.
  std::vector<Kernels> fixed_parents;
  FitOptions fixed = options;
  fixed.modes.free = false;
  double fallbacks = 0;
  for (int level = sizes.levels() - 1; level >= 0; --level) {
    const auto fitted = [&](const std::string& kind, const FitOptions& how,
                            const std::vector<Kernels>& from, const std::vector<Kernels>& hints) {
      return kept_or_fitted(
          checkpoint, fmt::format("{}_{}", kind, level), model.shape, sizes.texels(level), [&] {
            const int sweeps = from.empty() ? 1 : 1 + how.sweeps;
            progress.start(static_cast<std::int64_t>(sizes.texels(level)) * sweeps,
                           fmt::format("texels of {} {}", kind, level));
            return fit_level(data, samples, how, level, from, hints, scale, progress);
          });
    };
    if (options.modes.free) fixed_parents = fitted("fixed_level", fixed, fixed_parents, {}).kernels;
    LevelResult result = fitted("level", options, parents, fixed_parents);
    levels.insert(levels.begin(),
                  level_report(level, result, scale, mean_square(data, samples, level)));
    const double error = levels.front().at("relative_rmse");
    fallbacks += static_cast<double>(result.fallbacks);
    progress.report("relative_rmse_before_rounding", error);
    progress.report("texels_that_fell_back", fallbacks);
    kernels.insert(kernels.begin(), result.kernels.begin(), result.kernels.end());
    parents = std::move(result.kernels);
  }
  progress.finish();
  progress.report("pieces_kept", static_cast<double>(checkpoint.found()));
  model.report = Json{{"levels", levels}}.dump();
  model.set_kernels(kernels, scale);
  return model;
}

}  // namespace weft::srbf
