#include "codecs/lafortune/fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>

#include "codecs/lafortune/lafortune_fit.h"
#include "codecs/luminance.h"
#include "codecs/sample_check.h"

namespace weft::lafortune {

namespace {

// Luminances of one texel over the largest B / cos(theta_light), and the colour that a luminance of
// 1 has.
struct TexelSamples {
  std::vector<double> luminance;  // padded
  std::array<double, 3> colour{};
  bool is_black = true;
};

TexelSamples read_texel(const Btf& btf, const PairTable& pairs, std::size_t texel) {
  std::vector<float> abrdf(3 * btf.views().size() * btf.lights().size());
  const auto width = static_cast<std::size_t>(btf.width());
  btf.abrdf(static_cast<int>(texel % width), static_cast<int>(texel / width), abrdf);
  TexelSamples samples;
  samples.luminance.resize(pairs.padded());
  double largest = 0;
  double sum = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    double luminance = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = abrdf[3 * pairs.pair(i) + c];
      luminance += luminance_of_rgb[c] * value;
      samples.colour[c] += value;
    }
    samples.luminance[i] = luminance;
    largest = std::max(largest, luminance / pairs.cosine()[i]);
    sum += luminance;
  }
  if (!(sum > 0)) return samples;
  samples.is_black = false;
  for (double& luminance : samples.luminance) luminance /= largest;
  for (double& c : samples.colour) c *= largest / sum;
  return samples;
}

void write_texel(const Lafortune& fitted, const TexelSamples& samples, float* numbers) {
  for (int k = 0; k < fitted.count; ++k) {
    const Lobe& lobe = fitted.lobe[k];
    for (int c = 0; c < 3; ++c) numbers[4 * k + c] = static_cast<float>(lobe.axis[c] * lobe.peak);
    numbers[4 * k + 3] = static_cast<float>(lobe.exponent);
  }
  float* last = numbers + static_cast<std::ptrdiff_t>(4) * fitted.count;
  for (int c = 0; c < 3; ++c) last[c] = static_cast<float>(samples.colour[c]);
  last[3] = static_cast<float>(fitted.diffuse);
}

// As for reflectance fields: halfs hold all that a decoder computes.
void store_texels(Model& model) {
  constexpr float held = 8192;
  const std::size_t stride = 4 * model.quads();
  const auto is_colour = [&](std::size_t i) {
    return i % stride >= stride - 4 && i % stride < stride - 1;
  };
  float largest = 0;
  for (std::size_t i = 0; i < model.texels.size(); ++i) {
    if (is_colour(i)) largest = std::max(largest, model.texels[i]);
  }
  model.scale = largest > 0 ? largest / held : 1;
  for (std::size_t i = 0; i < model.texels.size(); ++i) {
    model.texels[i] =
        stored_value(model.storage, is_colour(i) ? model.texels[i] / model.scale : model.texels[i]);
  }
}

}  // namespace

Model fit(const Btf& btf, const FitOptions& options, Progress& progress) {
  refuse_invalid_samples(btf);
  Model model{.head = fitted_head(btf, to_json(options))};
  model.storage = options.storage;
  model.lobes = static_cast<std::size_t>(options.lobes);
  const std::size_t texels = model.head.texels();
  model.texels.resize(texels * 4 * model.quads());
  const PairTable pairs(btf.views(), btf.lights());
  progress.start(static_cast<std::int64_t>(texels), "texels");
  std::atomic<int> fell_back = 0;
  tbb::parallel_for(std::size_t{0}, texels, [&](std::size_t texel) {
    const TexelSamples samples = read_texel(btf, pairs, texel);
    TexelFit fitted{.model{.count = options.lobes}};
    if (!samples.is_black) fitted = fit_texel(pairs, samples.luminance, options.lobes);
    write_texel(fitted.model, samples, &model.texels[texel * 4 * model.quads()]);
    fell_back += fitted.fell_back ? 1 : 0;
    progress.advance(1);
  });
  progress.finish();
  progress.report("texels_that_fell_back", fell_back);
  store_texels(model);
  return model;
}

FitOptions fit_options(const Settings& parameters) {
  FitOptions options;
  options.lobes = static_cast<int>(parameters.integer("lobes", 2, 1, most_lobes));
  options.storage =
      parameters.choice("bits", {"half", "float"}) == "half" ? Storage::half : Storage::float32;
  parameters.finish();
  return options;
}

std::string parameter_help() {
  return "bits = half               half | float: what the texture holds\n"
         "lobes = 2                 of each texel, 1 to 3, beside the diffuse term\n";
}

std::string to_json(const FitOptions& options) {
  return nlohmann::json{{"bits", name_of(options.storage)}, {"lobes", options.lobes}}.dump();
}

}  // namespace weft::lafortune
