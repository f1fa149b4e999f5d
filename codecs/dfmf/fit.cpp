#include "codecs/dfmf/fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "btf/raw_appearance.h"
#include "codecs/dfmf/colour.h"
#include "codecs/sample_check.h"
#include "codecs/truncated_svd.h"

namespace weft::dfmf {

namespace {

using Eigen::Index;

// f = B / cos(theta_light) of a texel, [view][light][rgb]; 0 for lights on the horizon.
std::vector<float> texel_f(const Btf& btf, std::size_t texel,
                           const std::vector<float>& inverse_cosine) {
  std::vector<float> f(3 * btf.views().size() * btf.lights().size());
  const auto width = static_cast<std::size_t>(btf.width());
  btf.abrdf(static_cast<int>(texel % width), static_cast<int>(texel / width), f);
  for (std::size_t i = 0; i < f.size(); ++i) f[i] *= inverse_cosine[i / 3 % inverse_cosine.size()];
  return f;
}

float dot(const std::array<float, 3>& row, const float* rgb) {
  return row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2];
}

// Of f, over all samples.
double mean_luminance(const Btf& btf, const std::vector<float>& inverse_cosine) {
  std::vector<double> sums(static_cast<std::size_t>(btf.width()) * btf.height());
  const std::size_t pairs = btf.views().size() * btf.lights().size();
  tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t texel) {
    const std::vector<float> f = texel_f(btf, texel, inverse_cosine);
    for (std::size_t i = 0; i < pairs; ++i) sums[texel] += dot(yuv_of_rgb[0], &f[3 * i]);
  });
  return std::reduce(sums.begin(), sums.end()) / static_cast<double>(sums.size() * pairs);
}

// a of channel 0, b of 1, c of 2; see `Model`.
void decorrelated_row(const std::vector<float>& f, std::size_t channel, float epsilon,
                      float* values) {
  for (std::size_t i = 0; 3 * i < f.size(); ++i) {
    const float y = dot(yuv_of_rgb[0], &f[3 * i]);
    values[i] = channel == 0 ? std::log1p(y / epsilon)
                             : dot(yuv_of_rgb[channel], &f[3 * i]) / (y + epsilon);
  }
}

void store(const TruncatedSvd& svd, std::size_t channel, Model& model) {
  const std::size_t slots = model.slots();
  for (Index k = 0; k < svd.singular.size(); ++k) {
    const std::size_t slot = model.first_slot(channel) + k;
    const double weight_peak = svd.left.col(k).cwiseAbs().maxCoeff();
    const double basis_peak = svd.right.col(k).cwiseAbs().maxCoeff();
    const auto scale = static_cast<float>(svd.singular[k] * weight_peak * basis_peak);
    // A component of rounding alone says nothing; nor does one that a float cannot hold.
    if (!(svd.singular[k] > 1e-13 * svd.singular[0]) || !(scale > 0)) continue;
    model.scale[slot] = scale;
    for (Index texel = 0; texel < svd.left.rows(); ++texel) {
      model.weights[texel * slots + slot] =
          stored_value(model.storage, static_cast<float>(svd.left(texel, k) / weight_peak));
    }
    for (Index pair = 0; pair < svd.right.rows(); ++pair) {
      model.basis[pair * slots + slot] =
          stored_value(model.storage, static_cast<float>(svd.right(pair, k) / basis_peak));
    }
  }
}

}  // namespace

FitOptions fit_options(const Settings& parameters) {
  FitOptions options;
  const auto count = [&](const char* key, std::size_t fallback) {
    return static_cast<std::size_t>(
        parameters.integer(key, static_cast<std::int64_t>(fallback), 1, 256));
  };
  options.components = {count("components_y", 16), count("components_u", 8),
                        count("components_v", 8)};
  options.epsilon = parameters.number("epsilon", options.epsilon, 1e-6, 1e3);
  options.storage = storage_parameter(parameters);
  parameters.finish();
  return options;
}

std::string parameter_help() {
  return "bits = half               half | 8 | float: what the textures hold\n"
         "components_u = 8          of U / Y, 1 to 256\n"
         "components_v = 8          of V / Y, 1 to 256\n"
         "components_y = 16         of the logarithm of Y, 1 to 256\n"
         "epsilon = 0.01            times the data's mean luminance: what is added inside the "
         "logarithm\n";
}

std::string to_json(const FitOptions& options) {
  return nlohmann::json{{"bits", name_of(options.storage)},
                        {"components_u", options.components[1]},
                        {"components_v", options.components[2]},
                        {"components_y", options.components[0]},
                        {"epsilon", options.epsilon}}
      .dump();
}

Model fit(const Btf& btf, const FitOptions& options, Progress& progress) {
  refuse_invalid_samples(btf);
  Model model{.head = fitted_head(btf, to_json(options))};
  const std::vector<float> inverse_cosine = inverse_cosines(btf.lights());
  const auto epsilon = static_cast<float>(options.epsilon * mean_luminance(btf, inverse_cosine));
  model.epsilon = epsilon > 0 ? epsilon : 1;  // of a black BTF
  model.storage = options.storage;
  model.components = options.components;
  model.weights.resize(model.head.texels() * model.slots());
  model.basis.resize(model.head.pairs() * model.slots());
  model.scale.resize(model.slots());
  progress.start(3, "channels");
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const std::size_t pairs = model.head.pairs();
    const RowSource rows{model.head.texels(), pairs,
                         [&](std::size_t first, std::size_t count, float* values) {
                           for (std::size_t t = 0; t < count; ++t)
                             decorrelated_row(texel_f(btf, first + t, inverse_cosine), channel,
                                              model.epsilon, values + t * pairs);
                         }};
    TruncatedSvdOptions svd;
    svd.components = options.components[channel];
    store(truncated_svd(rows, svd), channel, model);
    progress.advance(1);
  }
  progress.finish();
  return model;
}

}  // namespace weft::dfmf
