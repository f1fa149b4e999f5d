#include "codecs/lafortune/fit.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "codecs/fit_checkpoint.h"
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
  double largest = 0;  // B / cos(theta_light), 1/sr
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
  samples.largest = largest;
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
  const std::size_t stride = 4 * model.quads();
  const auto is_colour = [&](std::size_t i) {
    return i % stride >= stride - 4 && i % stride < stride - 1;
  };
  float largest = 0;
  for (std::size_t i = 0; i < model.texels.size(); ++i) {
    if (!std::isfinite(model.texels[i])) {
      const std::size_t texel = i / stride;
      const auto width = static_cast<std::size_t>(model.head.width);
      throw beyond_float(fmt::format("texel ({}, {})", texel % width, texel / width));
    }
    if (is_colour(i)) largest = std::max(largest, model.texels[i]);
  }
  model.scale = colour_scale(largest);
  for (std::size_t i = 0; i < model.texels.size(); ++i) {
    model.texels[i] =
        stored_value(model.storage, is_colour(i) ? model.texels[i] / model.scale : model.texels[i]);
  }
}

// What a fit of the same data and parameters makes; raised whenever that changes.
constexpr int fit_version = 1;

// The parameters that a checkpoint is known by: rounding comes after the fit, so that what is kept
// serves any storage.
std::string fit_parameters(FitOptions options) {
  options.storage = Storage::float32;
  return to_json(options);
}

// Of some texels: squares of luminances in 1/sr, and how many fell back.
struct Tally {
  double squared_error = 0;
  double squared_data = 0;
  double fell_back = 0;

  static constexpr std::size_t numbers = 3;
  void add(const Tally& other) {
    squared_error += other.squared_error;
    squared_data += other.squared_data;
    fell_back += other.fell_back;
  }
};

Tally fit_one(const Btf& btf, const PairTable& pairs, int lobes, std::size_t texel,
              float* numbers) {
  const TexelSamples samples = read_texel(btf, pairs, texel);
  TexelFit fitted{.model{.count = lobes}};
  Tally tally;
  if (!samples.is_black) {
    fitted = fit_texel(pairs, samples.luminance, lobes);
    const double square = samples.largest * samples.largest;
    tally.squared_error = fitted.error * square;
    for (const double value : samples.luminance) tally.squared_data += value * value * square;
    tally.fell_back = fitted.fell_back ? 1 : 0;
  }
  write_texel(fitted.model, samples, numbers);
  return tally;
}

// A row of texels, side by side. `numbers` are the model's of that row.
Tally fit_row(const Btf& btf, const PairTable& pairs, int lobes, std::size_t row,
              std::span<float> numbers, Progress& progress) {
  const auto width = static_cast<std::size_t>(btf.width());
  std::vector<Tally> tallies(width);
  tbb::parallel_for(std::size_t{0}, width, [&](std::size_t x) {
    tallies[x] = fit_one(btf, pairs, lobes, row * width + x, &numbers[x * numbers.size() / width]);
    progress.advance(1);
  });
  Tally sum;
  for (const Tally& tally : tallies) sum.add(tally);
  return sum;
}

std::vector<double> packed(const Tally& tally, std::span<const float> numbers) {
  std::vector<double> piece(numbers.begin(), numbers.end());
  piece.insert(piece.end(), {tally.squared_error, tally.squared_data, tally.fell_back});
  return piece;
}

Tally unpacked(const std::vector<double>& piece, std::span<float> numbers) {
  std::transform(piece.begin(), piece.end() - Tally::numbers, numbers.begin(),
                 [](double v) { return static_cast<float>(v); });
  const double* tally = &piece[numbers.size()];
  return {tally[0], tally[1], tally[2]};
}

}  // namespace

Model fit(const Btf& btf, const FitOptions& options, Progress& progress) {
  refuse_invalid_samples(btf);
  Model model{.head = fitted_head(btf, to_json(options))};
  model.storage = options.storage;
  model.lobes = static_cast<std::size_t>(options.lobes);
  model.texels.resize(model.head.texels() * 4 * model.quads());
  const FitCheckpoint checkpoint = FitCheckpoint::of_fit(progress.kept_in(), btf, "lafortune",
                                                         fit_version, fit_parameters(options));
  const PairTable pairs(btf.views(), btf.lights());
  progress.start(static_cast<std::int64_t>(model.head.texels()), "texels");
  const std::size_t row_numbers = btf.width() * 4 * model.quads();
  Tally all;
  for (std::size_t row = 0; row < static_cast<std::size_t>(btf.height()); ++row) {
    const std::span<float> numbers(&model.texels[row * row_numbers], row_numbers);
    const std::string piece = fmt::format("row_{:04}", row);
    if (const auto found = checkpoint.find(piece, row_numbers + Tally::numbers)) {
      all.add(unpacked(*found, numbers));
      progress.advance(btf.width());
    } else {
      const Tally tally = fit_row(btf, pairs, options.lobes, row, numbers, progress);
      checkpoint.keep(piece, packed(tally, numbers));
      all.add(tally);
    }
    if (all.squared_data > 0) {
      progress.note(fmt::format("luminance error {:.2f} %",
                                100 * std::sqrt(all.squared_error / all.squared_data)));
    }
  }
  progress.finish();
  progress.report("texels_that_fell_back", all.fell_back);
  progress.report("pieces_kept", static_cast<double>(checkpoint.found()));
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
