#include "codecs/srbf/fit.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "codecs/sample_check.h"
#include "codecs/srbf/level_fit.h"

namespace weft::srbf {

namespace {

using Json = nlohmann::ordered_json;

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

}  // namespace

Model fit(const Btf& btf, const FitOptions& options, Progress& progress) {
  refuse_invalid_samples(btf);
  Model model{.head = fitted_head(btf, to_json(options))};
  model.storage = options.storage;
  model.shape = {options.kernels, options.modes.angles.size()};
  model.quantity = options.quantity;
  const Samples samples(btf.views(), btf.lights(), options.quantity);
  const MipLevels data(btf);
  const MipSizes& sizes = data.sizes();
  // The smallest float that is no worse for being divided by.
  const double scale = std::max(std::sqrt(mean_square(data, samples, 0)), 1e-30);

  Json levels = Json::array();
  std::string so_far;
  std::vector<Kernels> kernels;  // level 0 first
  std::vector<Kernels> parents;
  for (int level = sizes.levels() - 1; level >= 0; --level) {
    const int sweeps = parents.empty() ? 1 : 1 + options.sweeps;
    progress.start(static_cast<std::int64_t>(sizes.texels(level)) * sweeps,
                   fmt::format("texels of level {}{}", level, so_far));
    LevelResult result = fit_level(data, samples, options, level, parents, scale, progress);
    levels.insert(levels.begin(),
                  level_report(level, result, scale, mean_square(data, samples, level)));
    so_far = fmt::format(" (level {}: {:.2f} % off)", level,
                         100 * levels.front().at("relative_rmse").get<double>());
    kernels.insert(kernels.begin(), result.kernels.begin(), result.kernels.end());
    parents = std::move(result.kernels);
  }
  progress.finish();
  model.report = Json{{"levels", levels}}.dump();
  model.set_kernels(kernels, scale);
  return model;
}

}  // namespace weft::srbf
