#include "codecs/pca/fit.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

namespace weft::pca {

using Eigen::Index;

FitOptions fit_options(const Settings& parameters, std::size_t default_components) {
  FitOptions options;
  options.components = static_cast<std::size_t>(
      parameters.integer("components", static_cast<std::int64_t>(default_components), 1, 256));
  options.storage = storage_parameter(parameters);
  parameters.finish();
  return options;
}

std::string parameter_help(std::size_t default_components) {
  return fmt::format(
      "bits = half               half | 8 | float: what the textures hold (the mean of 8 is half)\n"
      "components = {:<2}           1 to 256, beside the mean; fewer where the data have fewer\n",
      default_components);
}

std::string to_json(const FitOptions& options) {
  return nlohmann::json{{"bits", name_of(options.storage)}, {"components", options.components}}
      .dump();
}

Model empty_model(const Btf& btf, const std::string& codec, std::size_t sets,
                  const FitOptions& options) {
  Model model{.codec = codec, .head = fitted_head(btf, to_json(options))};
  model.storage = options.storage;
  model.sets = sets;
  const std::size_t columns = 3 * model.head.pairs() / sets;
  model.components = std::min({options.components, model.head.texels(), columns});
  model.weights.resize(sets * model.head.texels() * model.padded());
  model.basis.resize(3 * model.head.pairs() * model.padded());
  model.mean.resize(4 * model.head.pairs());
  model.scale.resize(sets * model.padded());
  return model;
}

namespace {

void read_row(const Btf& btf, std::size_t texel, std::size_t first_view, std::size_t views,
              std::span<float> values) {
  const int x = static_cast<int>(texel) % btf.width();
  const int y = static_cast<int>(texel) / btf.width();
  if (views == btf.views().size()) return btf.abrdf(x, y, values);
  std::size_t i = 0;
  for (std::size_t view = first_view; view < first_view + views; ++view) {
    for (std::size_t light = 0; light < btf.lights().size(); ++light) {
      const Rgb value = btf.at(light, view, x, y);
      for (int c = 0; c < 3; ++c) values[i++] = value[c];
    }
  }
}

}  // namespace

RowSource abrdf_rows(const Btf& btf, std::size_t first_view, std::size_t views) {
  const std::size_t columns = 3 * btf.lights().size() * views;
  return {static_cast<std::size_t>(btf.width()) * btf.height(), columns,
          [&btf, columns, first_view, views](std::size_t first, std::size_t count, float* values) {
            for (std::size_t row = first; row < first + count; ++row, values += columns)
              read_row(btf, row, first_view, views, {values, columns});
          }};
}

void store_set(const TruncatedSvd& svd, std::size_t set, std::size_t first_view, Model& model) {
  const std::size_t padded = model.padded();
  const std::size_t first_weight = set * model.head.texels() * padded;
  const std::size_t first_value = 3 * first_view * model.head.lights.size();
  for (Index k = 0; k < svd.singular.size(); ++k) {
    const double weight_peak = svd.left.col(k).cwiseAbs().maxCoeff();
    const double basis_peak = svd.right.col(k).cwiseAbs().maxCoeff();
    const double scale = svd.singular[k] * weight_peak * basis_peak;
    // A component of rounding alone says nothing; nor does one that a float cannot hold.
    if (!(svd.singular[k] > 1e-13 * svd.singular[0]) || !(static_cast<float>(scale) > 0)) continue;
    model.scale[set * padded + k] = static_cast<float>(scale);
    for (Index row = 0; row < svd.left.rows(); ++row) {
      model.weights[first_weight + row * padded + k] =
          stored_value(model.storage, static_cast<float>(svd.left(row, k) / weight_peak));
    }
    for (Index column = 0; column < svd.right.rows(); ++column) {
      model.basis[(first_value + column) * padded + k] =
          stored_value(model.storage, static_cast<float>(svd.right(column, k) / basis_peak));
    }
  }
  for (Index column = 0; column < svd.mean.size(); ++column) {
    const std::size_t value = first_value + column;
    model.mean[value / 3 * 4 + value % 3] = static_cast<float>(svd.mean[column]);
  }
}

void store_means(Model& model) {
  for (const float value : model.mean)
    model.mean_scale = std::max(model.mean_scale, std::abs(value));
  for (float& value : model.mean) {
    value = model.mean_scale > 0 ? stored_value(model.mean_storage(), value / model.mean_scale) : 0;
  }
}

}  // namespace weft::pca
