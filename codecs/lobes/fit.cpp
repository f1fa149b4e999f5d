#include "codecs/lobes/fit.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "codecs/fit_checkpoint.h"
#include "codecs/lobes/lobe_starts.h"
#include "codecs/reflectance_fields/field_samples.h"
#include "codecs/sample_check.h"

namespace weft::lobes {

namespace {

using reflectance_fields::FieldSamples;
using reflectance_fields::Model;

// What a fit of the same data and parameters makes; raised whenever that changes.
constexpr int fit_version = 2;

// The parameters that a checkpoint is known by: rounding comes after the fit, so that what is kept
// serves any storage.
std::string fit_parameters(FitOptions options) {
  options.storage = Storage::float32;
  return to_json(options);
}

constexpr FitLimits limits{.iterations = 40, .tolerance = 1e-5};

// Counts of one view's fields, and their errors.
struct Tally {
  double squared_error = 0;
  double squared_data = 0;
  double fell_back = 0;
  double narrowest = 0;
  double widest = 0;
  double highest = 0;

  static constexpr std::size_t numbers = 6;
  std::array<double*, numbers> each() {
    return {&squared_error, &squared_data, &fell_back, &narrowest, &widest, &highest};
  }
  void add(Tally other) {
    for (std::size_t i = 0; i < numbers; ++i) *each()[i] += *other.each()[i];
  }
};

// Floats of one field in the model: (w, n) a lobe, then the colour.
void write_field(const LobeSum& lobes, const FieldSamples& samples, float* field) {
  for (int k = 0; k < lobes.count; ++k) {
    const Lobe& lobe = lobes.lobe[k];
    for (int c = 0; c < 3; ++c) field[4 * k + c] = static_cast<float>(lobe.axis[c] * lobe.peak);
    field[4 * k + 3] = static_cast<float>(lobe.exponent);
  }
  for (int c = 0; c < 3; ++c) field[4 * lobes.count + c] = static_cast<float>(samples.colour[c]);
}

LobeSum read_lobes(const float* field, int count) {
  LobeSum lobes;
  lobes.count = count;
  for (int k = 0; k < count; ++k) {
    Lobe& lobe = lobes.lobe[k];
    const float* w = field + 4 * k;
    lobe.peak = std::hypot(w[0], w[1], w[2]);
    for (int c = 0; c < 3 && lobe.peak > 0; ++c) lobe.axis[c] = w[c] / lobe.peak;
    lobe.exponent = w[3];
  }
  return lobes;
}

class BtfFit {
 public:
  BtfFit(const Btf& btf, const FitOptions& options)
      : btf_(btf),
        options_(options),
        lights_(btf.lights()),
        model_(reflectance_fields::empty_model(btf, "lobes", reflectance_fields::Kind::lobes,
                                               static_cast<std::size_t>(options.lobes),
                                               options.storage, to_json(options))) {
    for (std::size_t i = 0; i < lights_.size(); ++i) light_numbers_.push_back(lights_.index(i));
  }

  Model run(Progress& progress) {
    const FitCheckpoint checkpoint = FitCheckpoint::of_fit(progress.kept_in(), btf_, "lobes",
                                                           fit_version, fit_parameters(options_));
    progress.start(static_cast<std::int64_t>(btf_.views().size() * texels()), "fields");
    Tally all;
    for_some_views(btf_, [&](std::size_t first, const Btf& part) {
      for (std::size_t v = 0; v < part.views().size(); ++v) {
        all.add(keep_or_fit(checkpoint, first + v, part, v, progress));
        if (all.squared_data > 0) {
          progress.note(fmt::format("luminance error {:.2f} %",
                                    100 * std::sqrt(all.squared_error / all.squared_data)));
        }
      }
    });
    progress.finish();
    progress.report("fields_that_fell_back", all.fell_back);
    progress.report("lobes_at_least_exponent", all.widest);
    progress.report("lobes_at_largest_exponent", all.narrowest);
    progress.report("lobes_at_largest_peak", all.highest);
    progress.report("pieces_kept", static_cast<double>(checkpoint.found()));
    reflectance_fields::store_fields(model_);
    return std::move(model_);
  }

 private:
  std::size_t texels() const { return model_.head.texels(); }
  float* field(std::size_t view, std::size_t texel) {
    return &model_.fields[(view * texels() + texel) * model_.floats_a_field()];
  }
  std::size_t view_floats() const { return texels() * model_.floats_a_field(); }
  std::size_t kept_numbers() const { return view_floats() + Tally::numbers; }

  std::vector<double> packed(Tally tally, std::size_t view) {
    std::vector<double> numbers(field(view, 0), field(view, 0) + view_floats());
    for (const double* number : tally.each()) numbers.push_back(*number);
    return numbers;
  }

  Tally unpacked(const std::vector<double>& numbers, std::size_t view) {
    std::transform(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(view_floats()),
                   field(view, 0), [](double v) { return static_cast<float>(v); });
    Tally tally;
    for (std::size_t i = 0; i < Tally::numbers; ++i) *tally.each()[i] = numbers[view_floats() + i];
    return tally;
  }

  // View `view`, which is number `v` of `part`: as an earlier run left it, or fitted.
  Tally keep_or_fit(const FitCheckpoint& checkpoint, std::size_t view, const Btf& part,
                    std::size_t v, Progress& progress) {
    const std::string piece = fmt::format("view_{:03}", view);
    if (const auto found = checkpoint.find(piece, kept_numbers())) {
      progress.advance(static_cast<std::int64_t>(texels()));
      return unpacked(*found, view);
    }
    const Tally tally = fit_view(view, part, v, progress);
    checkpoint.keep(piece, packed(tally, view));
    return tally;
  }

  // The view among those that are fitted that is nearest to this one.
  std::size_t nearest_before(std::size_t view) const {
    std::size_t nearest = 0;
    for (std::size_t v = 1; v < view; ++v) {
      if ((btf_.views()[v] ^ btf_.views()[view]) > (btf_.views()[nearest] ^ btf_.views()[view]))
        nearest = v;
    }
    return nearest;
  }

  Tally fit_view(std::size_t view, const Btf& part, std::size_t v, Progress& progress) {
    std::vector<Tally> tallies(texels());
    const std::size_t before = nearest_before(view);
    tbb::parallel_for(std::size_t{0}, texels(), [&](std::size_t texel) {
      std::vector<LobeSum> others;
      if (view > 0) others.push_back(read_lobes(field(before, texel), options_.lobes));
      FieldSamples samples;
      reflectance_fields::read_field(part, v, texel, light_numbers_, samples);
      tallies[texel] = fit_texel(samples, others, field(view, texel));
      progress.advance(1);
    });
    Tally sum;
    for (const Tally& tally : tallies) sum.add(tally);
    return sum;
  }

  Tally fit_texel(FieldSamples& samples, std::span<const LobeSum> others, float* field) {
    FieldFit fitted;
    fitted.lobes.count = options_.lobes;
    Tally tally;
    if (samples.largest > 0) {
      samples.luminance.resize(lights_.padded());
      fitted = fit_field(lights_, samples.luminance, options_.lobes, others);
      const double square = samples.largest * samples.largest;
      tally.squared_error = fitted.error * square;
      for (const double value : samples.luminance) tally.squared_data += value * value * square;
      tally.fell_back = fitted.fell_back ? 1 : 0;
      for (int k = 0; k < options_.lobes; ++k) {
        const Lobe& lobe = fitted.lobes.lobe[k];
        if (!(lobe.peak > 0)) continue;
        tally.narrowest += lobe.exponent >= largest_exponent ? 1 : 0;
        tally.widest += lobe.exponent <= least_exponent ? 1 : 0;
        tally.highest += lobe.peak >= largest_peak ? 1 : 0;
      }
    }
    write_field(fitted.lobes, samples, field);
    return tally;
  }

  const Btf& btf_;
  const FitOptions& options_;
  LightTable lights_;
  std::vector<std::size_t> light_numbers_;
  Model model_;
};

}  // namespace

FieldFit fit_field(const LightTable& lights, std::span<const double> values, int count,
                   std::span<const LobeSum> others) {
  FieldFit best;
  best.lobes = cosine_lobe(lights, values, count);
  best.error = squared_error(lights, values, best.lobes);
  best.fell_back = true;
  std::vector<LobeSum> all = starts(lights, values, count, limits);
  all.insert(all.end(), others.begin(), others.end());
  for (LobeSum& lobes : all) {
    const double error = improve(lights, values, limits, lobes);
    if (!(error <= best.error) || std::isinf(error)) continue;  // a NaN is no fit
    best = {lobes, error, false};
  }
  return best;
}

Model fit(const Btf& btf, const FitOptions& options, Progress& progress) {
  refuse_invalid_samples(btf);
  return BtfFit(btf, options).run(progress);
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
         "lobes = 2                 of each view and texel, 1 to 4\n";
}

std::string to_json(const FitOptions& options) {
  return nlohmann::json{{"bits", name_of(options.storage)}, {"lobes", options.lobes}}.dump();
}

}  // namespace weft::lobes
