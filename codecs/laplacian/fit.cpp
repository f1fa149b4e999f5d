#include "codecs/laplacian/fit.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "btf/error.h"
#include "codecs/laplacian/colour.h"
#include "codecs/sample_check.h"
#include "codecs/truncated_svd.h"

namespace weft::laplacian {

namespace {

using Eigen::Index;

/// All texels of one level and one channel, [texel][pair].
using Level = LargeArray<float>;

// One channel of the BTF. Level 0 is read from the data again and again; the coarser ones, a third
// of its size, are kept. `levels[k]` is F_k at first, and L_k, or what L_k decodes to, at the end.
class ChannelFit {
 public:
  ChannelFit(const Btf& btf, const FitOptions& options, std::size_t channel, Model& model)
      : btf_(btf),
        options_(options),
        channel_(channel),
        model_(model),
        pyramid_(model.pyramid),
        pairs_(model.head.pairs()),
        levels_(static_cast<std::size_t>(model.levels())) {}

  // Equations 2 to 6, from the top down.
  void run() {
    for (int k = 1; k <= pyramid_.top; ++k) levels_[k] = next_level(k);
    fit_top_mean();
    for (int k = pyramid_.top; k >= 0; --k) {
      TruncatedSvdOptions svd;
      svd.components = model_.components[channel_];
      svd.centred = k == pyramid_.top && options_.around == TopAround::mean;
      const RowSource rows{pyramid_.texels(k), pairs_,
                           [&, k](std::size_t first, std::size_t count, float* values) {
                             for (std::size_t t = 0; t < count; ++t)
                               laplacian_row(k, first + t, values + t * pairs_, true);
                           }};
      store(truncated_svd(rows, svd), k);
      if (k > 0) replace_level(k);
    }
  }

 private:
  // F_0 of a texel.
  void data_row(std::size_t texel, float* values) const {
    std::vector<float> abrdf(3 * pairs_);
    const auto width = static_cast<std::size_t>(btf_.width());
    btf_.abrdf(static_cast<int>(texel % width), static_cast<int>(texel / width), abrdf);
    const auto& row = ycbcr_of_rgb[channel_];
    const auto r = static_cast<float>(row[0]);
    const auto g = static_cast<float>(row[1]);
    const auto b = static_cast<float>(row[2]);
    for (std::size_t i = 0; i < pairs_; ++i)
      values[i] = r * abrdf[3 * i] + g * abrdf[3 * i + 1] + b * abrdf[3 * i + 2];
  }

  // Equation 2.
  Level next_level(int level) const {
    Level coarse(pyramid_.texels(level) * pairs_, btf_.memory());
    tbb::parallel_for(std::size_t{0}, pyramid_.texels(level), [&](std::size_t texel) {
      std::vector<double> sum(pairs_, 0.0);
      std::vector<float> read(pairs_);
      for (const Tap& tap : pyramid_.down(level, texel)) {
        const float* fine = read.data();
        if (level == 1)
          data_row(tap.texel, read.data());
        else
          fine = &levels_[level - 1][tap.texel * pairs_];
        for (std::size_t i = 0; i < pairs_; ++i) sum[i] += tap.weight * fine[i];
      }
      std::ranges::transform(sum, &coarse[texel * pairs_],
                             [](double v) { return static_cast<float>(v); });
    });
    return coarse;
  }

  // Equation 3; at the top F itself, less the model of its mean where the components are taken
  // around that.
  void laplacian_row(int level, std::size_t texel, float* values, bool less_model) const {
    if (level == 0)
      data_row(texel, values);
    else
      std::copy_n(&levels_[level][texel * pairs_], pairs_, values);
    for (int k = level + 1; k <= pyramid_.top; ++k) {
      for (const Tap& tap : pyramid_.up(level, texel, k)) {
        const float* coarse = &levels_[k][tap.texel * pairs_];
        const auto weight = static_cast<float>(tap.weight);
        for (std::size_t i = 0; i < pairs_; ++i) values[i] -= weight * coarse[i];
      }
    }
    if (less_model && level == pyramid_.top && options_.around == TopAround::model) {
      for (std::size_t i = 0; i < pairs_; ++i) values[i] -= modelled_mean_[i];
    }
  }

  // Equations 5 and 6.
  void fit_top_mean() {
    std::vector<double> mean(pairs_, 0.0);
    std::vector<float> row(pairs_);
    const std::size_t count = pyramid_.texels(pyramid_.top);
    for (std::size_t texel = 0; texel < count; ++texel) {
      laplacian_row(pyramid_.top, texel, row.data(), false);
      for (std::size_t i = 0; i < pairs_; ++i) mean[i] += row[i] / static_cast<double>(count);
    }
    if (channel_ == 0)
      model_.mean_y = fit_phong(model_.head.views, model_.head.lights, mean);
    else
      model_.mean_chroma[channel_ - 1] = chroma_factor(mean);
    modelled_mean_.resize(pairs_);
    for (std::size_t i = 0; i < pairs_; ++i) modelled_mean_[i] = modelled(i);
  }

  Direction light_of(std::size_t pair) const {
    return model_.head.lights[pair % model_.head.lights.size()];
  }

  // Least squares of c, or of c cos(theta_light).
  float chroma_factor(const std::vector<double>& mean) const {
    double product = 0;
    double square = 0;
    for (std::size_t i = 0; i < pairs_; ++i) {
      const double basis = model_.chroma == ChromaMean::cosine ? light_of(i).z : 1.0;
      product += basis * mean[i];
      square += basis * basis;
    }
    return square > 0 ? static_cast<float>(product / square) : 0.0F;
  }

  float modelled(std::size_t pair) const {
    const Direction& light = light_of(pair);
    const Direction& view = model_.head.views[pair / model_.head.lights.size()];
    if (!(light.z > 0) || !(view.z > 0)) return 0;
    if (channel_ == 0) return model_.mean_y(light, view);
    const float c = model_.mean_chroma[channel_ - 1];
    return model_.chroma == ChromaMean::cosine ? c * light.z : c;
  }

  void store(const TruncatedSvd& svd, int level) {
    const std::size_t slots = model_.slots();
    const std::size_t first_row = model_.first_weight_row(level);
    for (Index k = 0; k < svd.singular.size(); ++k) {
      const std::size_t slot = model_.first_slot(channel_) + k;
      const double weight_peak = svd.left.col(k).cwiseAbs().maxCoeff();
      const double eigen_peak = svd.right.col(k).cwiseAbs().maxCoeff();
      const auto scale = static_cast<float>(svd.singular[k] * weight_peak * eigen_peak);
      // A component of rounding alone says nothing; nor does one that a float cannot hold.
      if (!(svd.singular[k] > 1e-13 * svd.singular[0]) || !(scale > 0)) continue;
      model_.scale[level * slots + slot] = scale;
      for (Index row = 0; row < svd.left.rows(); ++row) {
        model_.weights[(first_row + row) * slots + slot] =
            stored_value(model_.storage, static_cast<float>(svd.left(row, k) / weight_peak));
      }
      for (Index pair = 0; pair < svd.right.rows(); ++pair) {
        model_.eigen[(level * pairs_ + pair) * slots + slot] =
            stored_value(model_.storage, static_cast<float>(svd.right(pair, k) / eigen_peak));
      }
    }
  }

  // F_k becomes what finer levels are predicted with: L_k, or what it decodes to.
  void replace_level(int level) {
    const std::size_t slots = model_.slots();
    const std::size_t first_row = model_.first_weight_row(level);
    Level replaced(levels_[level].size(), btf_.memory());
    tbb::parallel_for(std::size_t{0}, pyramid_.texels(level), [&](std::size_t texel) {
      float* row = &replaced[texel * pairs_];
      if (!options_.closed_loop) return laplacian_row(level, texel, row, false);
      if (level == pyramid_.top) std::ranges::copy(modelled_mean_, row);
      for (std::size_t j = 0; j < model_.components[channel_]; ++j) {
        const std::size_t slot = model_.first_slot(channel_) + j;
        const float weight =
            model_.weights[(first_row + texel) * slots + slot] * model_.scale[level * slots + slot];
        for (std::size_t i = 0; i < pairs_; ++i)
          row[i] += weight * model_.eigen[(level * pairs_ + i) * slots + slot];
      }
    });
    levels_[level] = std::move(replaced);
  }

  const Btf& btf_;
  const FitOptions& options_;
  std::size_t channel_;
  Model& model_;
  const Pyramid& pyramid_;
  std::size_t pairs_;
  std::vector<Level> levels_;
  std::vector<float> modelled_mean_;
};

int top_of(const Btf& btf, const FitOptions& options) {
  if (options.top < 0) return usual_top(btf.width(), btf.height(), options.components[0]);
  const int most = most_levels(btf.width(), btf.height());
  if (options.top > most) {
    throw bad_input("levels", fmt::format("{}; {} x {} texels have at most {}", options.top + 1,
                                          btf.width(), btf.height(), most + 1));
  }
  return options.top;
}

}  // namespace

Model fit(const Btf& btf, const FitOptions& options, Progress& progress) {
  Model model{.head = fitted_head(btf, to_json(options))};
  model.pyramid = {btf.width(), btf.height(), top_of(btf, options), options.filters};
  refuse_invalid_samples(btf);
  model.storage = options.storage;
  model.components = options.components;
  model.interpolated = options.interpolated;
  model.chroma = options.chroma;
  model.eigen.resize(model.levels() * model.head.pairs() * model.slots());
  model.weights.resize(model.first_weight_row(model.levels()) * model.slots());
  model.scale.resize(model.levels() * model.slots());
  progress.start(3, "channels");
  for (std::size_t channel = 0; channel < 3; ++channel) {
    ChannelFit(btf, options, channel, model).run();
    progress.advance(1);
  }
  progress.finish();
  return model;
}

}  // namespace weft::laplacian
