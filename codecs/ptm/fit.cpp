#include "codecs/ptm/fit.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "codecs/reflectance_fields/field_samples.h"
#include "codecs/sample_check.h"

namespace weft::ptm {

namespace {

using reflectance_fields::FieldSamples;
using reflectance_fields::Kind;
using reflectance_fields::Model;

constexpr Eigen::Index terms = 6;
using Coefficients = Eigen::Matrix<double, terms, 1>;

// The polynomial's terms at the lights, times their cosines where that is outside, and what maps
// the samples of one field to its coefficients: their pseudo-inverse.
struct Solver {
  Eigen::Matrix<double, Eigen::Dynamic, terms> matrix;
  Eigen::Matrix<double, terms, Eigen::Dynamic> inverse;
};

Solver solver(const HemisphereSampling& lights, const std::vector<std::size_t>& numbers,
              bool cosine_outside) {
  Eigen::Matrix<double, Eigen::Dynamic, terms> matrix(numbers.size(), terms);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double x = lights[numbers[i]].x;
    const double y = lights[numbers[i]].y;
    const double by = cosine_outside ? lights[numbers[i]].z : 1;
    matrix.row(static_cast<Eigen::Index>(i)) << by * x * x, by * y * y, by * x * y, by * x, by * y,
        by;
  }
  return {matrix, matrix.completeOrthogonalDecomposition().pseudoInverse()};
}

// Squares of some samples and of what polynomials miss of them, in 1/sr.
struct Misfit {
  double squared_error = 0;
  double squared_data = 0;

  void add(const Misfit& other) {
    squared_error += other.squared_error;
    squared_data += other.squared_data;
  }
};

Misfit misfit(const Solver& solve, const auto& values, const auto& coefficients) {
  return {(values - (solve.matrix * coefficients).cwiseMax(0)).squaredNorm(), values.squaredNorm()};
}

Kind kind_of(const FitOptions& options) {
  if (options.per_channel) return options.cosine_outside ? Kind::rgb_cosine : Kind::rgb;
  return options.cosine_outside ? Kind::luminance_cosine : Kind::luminance;
}

Misfit fit_luminance(const FieldSamples& samples, const Solver& solve, float* field) {
  const Eigen::Map<const Eigen::VectorXd> values(
      samples.luminance.data(), static_cast<Eigen::Index>(samples.luminance.size()));
  const Coefficients c = solve.inverse * values;
  // The largest is 1, so that no half overflows.
  const double largest = c.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return {};
  for (Eigen::Index k = 0; k < terms; ++k) field[k] = static_cast<float>(c[k] / largest);
  for (int channel = 0; channel < 3; ++channel)
    field[8 + channel] = static_cast<float>(samples.colour[channel] * largest);
  const Misfit over_largest = misfit(solve, values, c);
  const double square = samples.largest * samples.largest;
  return {over_largest.squared_error * square, over_largest.squared_data * square};
}

Misfit fit_channels(const Btf& btf, std::size_t view, std::size_t texel,
                    const std::vector<std::size_t>& lights, const Solver& solve, float* field) {
  const auto width = static_cast<std::size_t>(btf.width());
  Eigen::Matrix<double, Eigen::Dynamic, 3> values(lights.size(), 3);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const Rgb value =
        btf.at(lights[i], view, static_cast<int>(texel % width), static_cast<int>(texel / width));
    for (int c = 0; c < 3; ++c) values(static_cast<Eigen::Index>(i), c) = value[c];
  }
  const Eigen::Matrix<double, terms, 3> c = solve.inverse * values;
  for (Eigen::Index k = 0; k < terms; ++k) {
    for (int channel = 0; channel < 3; ++channel)
      field[4 * k + channel] = static_cast<float>(c(k, channel));
  }
  return misfit(solve, values, c);
}

std::string note_of(const Misfit& all, const FitOptions& options) {
  return fmt::format("{} {:.2f} %", options.per_channel ? "error" : "luminance error",
                     100 * std::sqrt(all.squared_error / std::max(all.squared_data, 1e-300)));
}

}  // namespace

Model fit(const Btf& btf, const FitOptions& options, Progress& progress) {
  refuse_invalid_samples(btf);
  Model model = reflectance_fields::empty_model(btf, "ptm", kind_of(options), 0, options.storage,
                                                to_json(options));
  const std::size_t texels = model.head.texels();
  const std::vector<std::size_t> lights = reflectance_fields::lights_above_horizon(btf.lights());
  progress.start(static_cast<std::int64_t>(btf.views().size()), "views");
  if (!lights.empty()) {
    const Solver solve = solver(btf.lights(), lights, options.cosine_outside);
    Misfit all;
    for_some_views(btf, [&](std::size_t first, const Btf& part) {
      for (std::size_t view = 0; view < part.views().size(); ++view) {
        std::vector<Misfit> misfits(texels);
        tbb::parallel_for(std::size_t{0}, texels, [&](std::size_t texel) {
          float* field = &model.fields[((first + view) * texels + texel) * model.floats_a_field()];
          if (options.per_channel) {
            misfits[texel] = fit_channels(part, view, texel, lights, solve, field);
            return;
          }
          FieldSamples samples;
          reflectance_fields::read_field(part, view, texel, lights, samples);
          misfits[texel] = fit_luminance(samples, solve, field);
        });
        for (const Misfit& one : misfits) all.add(one);
        progress.note(note_of(all, options));
        progress.advance(1);
      }
    });
  }
  progress.finish();
  reflectance_fields::store_fields(model);
  return model;
}

FitOptions fit_options(const Settings& parameters) {
  FitOptions options;
  options.per_channel = parameters.choice("colour", {"average", "channels"}) == "channels";
  options.cosine_outside = parameters.choice("cosine", {"outside", "inside"}) == "outside";
  options.storage =
      parameters.choice("bits", {"half", "float"}) == "half" ? Storage::half : Storage::float32;
  parameters.finish();
  return options;
}

std::string parameter_help() {
  return "bits = half               half | float: what the texture holds\n"
         "colour = average          average: luminance times the view's and texel's average "
         "colour; "
         "channels: a polynomial each\n"
         "cosine = outside          outside: the polynomial times cos(theta_light); inside: the "
         "polynomial alone\n";
}

std::string to_json(const FitOptions& options) {
  return nlohmann::json{{"bits", name_of(options.storage)},
                        {"colour", options.per_channel ? "channels" : "average"},
                        {"cosine", options.cosine_outside ? "outside" : "inside"}}
      .dump();
}

}  // namespace weft::ptm
