#include "codecs/cmf/fit.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "btf/error.h"
#include "btf/raw_appearance.h"
#include "codecs/cmf/k_means.h"
#include "codecs/cmf/scale_map.h"

namespace weft::cmf {

namespace {

// All texels' maps, a row a texel, [row][column][rgb], each channel's largest value 1.
struct NormalisedFactor {
  Projection projection;
  RowMatrix maps;
};

struct NormalisedFactors {
  std::vector<NormalisedFactor> factors;
  std::vector<float> scale;  // S: the product of what the factors were divided by, [texel][rgb]
};

Error invalid_sample(const Btf& btf, std::size_t light, std::size_t view, int texel, float value) {
  return bad_input(
      "BTF", fmt::format("view {}, light {}, texel ({}, {}): {} is not a finite number >= 0", view,
                         light, texel % btf.width(), texel / btf.width(), value));
}

// f = B / cos(theta_light) of up to 16 texels from `first` on, [light][view]; 0 for lights on the
// horizon.
LaneVector read_block(const Btf& btf, int first, int count) {
  const std::size_t n_lights = btf.lights().size();
  const std::size_t n_views = btf.views().size();
  LaneVector f(n_lights * n_views);
  const std::vector<float> inverse_cosine = inverse_cosines(btf.lights());
  std::vector<float> values(3 * f.size());
  for (int t = 0; t < count; ++t) {
    btf.abrdf((first + t) % btf.width(), (first + t) / btf.width(), values);
    const float* p = values.data();
    for (std::size_t view = 0; view < n_views; ++view) {
      for (std::size_t light = 0; light < n_lights; ++light, p += 3) {
        Lanes& lanes = f[light * n_views + view];
        for (int c = 0; c < 3; ++c) {
          if (!(p[c] >= 0) || !std::isfinite(p[c]))
            throw invalid_sample(btf, light, view, first + t, p[c]);
          lanes[3 * t + c] = p[c] * inverse_cosine[light];
        }
      }
    }
  }
  return f;
}

// Writes a block's maps of one factor as rows, each divided by its largest value, which multiplies
// `scale`.
void store(const LaneVector& maps, int first, int count, RowMatrix& rows,
           std::vector<float>& scale) {
  for (int k = 0; k < 3 * count; ++k) {
    float largest = 0;
    for (const Lanes& texel : maps) largest = std::max(largest, texel[k]);
    float* row = rows.row(first + k / 3).data();
    for (std::size_t t = 0; t < maps.size(); ++t) {
      row[3 * t + k % 3] = largest > 0 ? maps[t][k] / largest : 0.0F;
    }
    scale[3 * static_cast<std::size_t>(first) + k] *= largest;
  }
}

NormalisedFactors factorise(const Btf& btf, const ChainOptions& options, Progress& progress) {
  const Chain chain(btf.lights(), btf.views(), options);
  const int n_texels = btf.width() * btf.height();
  const int values = 3 * options.resolution * options.resolution;
  NormalisedFactors result;
  result.scale.assign(3 * static_cast<std::size_t>(n_texels), 1.0F);
  result.factors.push_back({Projection::light, RowMatrix(n_texels, values)});
  if (options.half) result.factors.push_back({Projection::half, RowMatrix(n_texels, values)});
  result.factors.push_back({Projection::view, RowMatrix(n_texels, values)});
  progress.start(n_texels, "texels");
  tbb::parallel_for(0, (n_texels + texels_a_block - 1) / texels_a_block, [&](int block) {
    const int first = block * texels_a_block;
    const int count = std::min(texels_a_block, n_texels - first);
    const FactorMaps maps = chain.factorise(read_block(btf, first, count));
    store(maps.light, first, count, result.factors.front().maps, result.scale);
    if (options.half) store(maps.half, first, count, result.factors[1].maps, result.scale);
    store(maps.view, first, count, result.factors.back().maps, result.scale);
    progress.advance(count);
  });
  return result;
}

RgbArray rgb_array(const float* values, std::size_t count, bool eight_bit) {
  std::vector<float> floats(values, values + count);
  if (eight_bit) return {to_bytes(floats), {}};
  return {{}, std::move(floats)};
}

// Section 5: a codebook of prototypes and an index map a factor, RGB jointly.
void cluster_factor(const RowMatrix& maps, std::size_t factor, const FitOptions& options,
                    Model& model, Progress& progress) {
  progress.start(max_k_means_iterations, "iterations");
  const Clustering clustering = k_means(maps, options.clusters, options.seed + factor, progress);
  model.factors[factor].maps =
      rgb_array(clustering.prototypes.data(), clustering.prototypes.size(), options.eight_bit);
  for (std::size_t texel = 0; texel < clustering.index.size(); ++texel) {
    model.index[3 * texel + factor] = static_cast<std::uint8_t>(clustering.index[texel]);
  }
}

// Section 6: the scale map divided by its largest value in each channel (see `Model::scale`).
void store_scale(std::vector<float> scale, bool eight_bit, Model& model) {
  Rgb largest(0, 0, 0);
  for (std::size_t i = 0; i < scale.size(); ++i) {
    largest[static_cast<int>(i % 3)] = std::max(largest[static_cast<int>(i % 3)], scale[i]);
  }
  for (std::size_t i = 0; i < scale.size(); ++i) {
    const float divisor = largest[static_cast<int>(i % 3)];
    const float share = divisor > 0 ? scale[i] / divisor : 0;
    scale[i] = eight_bit ? std::sqrt(share) : share;
  }
  model.scale_max = largest;
  model.scale = rgb_array(scale.data(), scale.size(), eight_bit);
}

}  // namespace

Model fit(const Btf& btf, const FitOptions& options, Progress& progress) {
  NormalisedFactors normalised = factorise(btf, options.chain, progress);
  Model model{.width = btf.width(),
              .height = btf.height(),
              .resolution = options.chain.resolution,
              .clustered = options.clustered,
              .factors = {},
              .index = {},
              .scale = {},
              .scale_max = Rgb(1, 1, 1),
              .views = btf.views(),
              .lights = btf.lights(),
              .parameters = to_json(options),
              .provenance = btf.provenance};
  if (options.clustered) model.index.resize(normalised.scale.size());
  for (std::size_t f = 0; f < normalised.factors.size(); ++f) {
    RowMatrix maps = std::move(normalised.factors[f].maps);  // freed at the end of its turn
    model.factors.push_back({normalised.factors[f].projection, {}});
    if (options.clustered)
      cluster_factor(maps, f, options, model, progress);
    else
      model.factors[f].maps = rgb_array(maps.data(), maps.size(), options.eight_bit);
  }
  std::vector<float> scale =
      options.refit_scale ? least_squares_scale(btf, model) : std::move(normalised.scale);
  store_scale(std::move(scale), options.eight_bit, model);
  progress.finish();
  return model;
}

}  // namespace weft::cmf
