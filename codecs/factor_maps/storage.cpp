#include "codecs/factor_maps/storage.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "btf/error.h"
#include "codecs/factor_maps/codebook_refinement.h"
#include "codecs/factor_maps/scale_map.h"

namespace weft::factor_maps {

StorageOptions storage_options(const Settings& parameters, int refine_codebooks) {
  StorageOptions options;
  options.eight_bit = parameters.choice("bits", {"8", "float"}) == "8";
  options.clustered = parameters.flag("clustered", options.clustered);
  options.levels = parameters.flag("levels", options.levels);
  options.refit_scale = parameters.flag("refit_scale", options.refit_scale);
  options.weighted = parameters.flag("weighted", options.weighted);
  const bool refinable = options.clustered && options.refit_scale;
  options.refine_codebooks = static_cast<int>(
      parameters.integer("refine_codebooks", refinable ? refine_codebooks : 0, 0, 1000));
  if (options.refine_codebooks > 0 && !refinable) {
    throw bad_input(parameters.where("refine_codebooks"),
                    "refine_codebooks needs clustered=true and refit_scale=true", "leave it out");
  }
  options.resolution =
      static_cast<int>(parameters.integer("resolution", options.resolution, 2, 256));
  ClusterOptions& clustering = options.clustering;
  clustering.clusters =
      static_cast<int>(parameters.integer("clusters", clustering.clusters, 1, 256));
  clustering.method = parameters.choice("clustering", {"k-means", "tree"}) == "tree"
                          ? ClusterMethod::tree
                          : ClusterMethod::k_means;
  clustering.metric = parameters.choice("metric", {"euclidean", "cosine"}) == "cosine"
                          ? ClusterMetric::cosine
                          : ClusterMetric::euclidean;
  clustering.seed = static_cast<std::uint64_t>(
      parameters.integer("seed", 0, 0, std::numeric_limits<std::int64_t>::max()));
  return options;
}

std::string storage_help(int refine_codebooks) {
  return "bits = 8                  8 | float: what the textures hold\n"
         "clustered = true          codebooks and index maps; false: every texel keeps its own "
         "maps\n"
         "clustering = k-means      k-means | tree: how a codebook is found\n"
         "clusters = 256            size of each factor's codebook, 1 to 256\n"
         "levels = true             mip levels, fitted to the data's and sharing the codebooks\n"
         "metric = euclidean        euclidean | cosine: which maps are alike\n"
         "refine_codebooks = " +
         std::to_string(refine_codebooks) +
         "      rounds that improve codebooks and indices together, against the data\n"
         "refit_scale = true        solve the scale map again after clustering and quantisation\n"
         "resolution = 32           texels a side of each parabolic map, 2 to 256\n"
         "seed = 0                  of k-means++\n"
         "weighted = true           clustering weighs a texel by the energy that is seen of it\n";
}

void add_to(nlohmann::json& parameters, const StorageOptions& options) {
  const ClusterOptions& clustering = options.clustering;
  parameters["bits"] = options.eight_bit ? "8" : "float";
  parameters["clustered"] = options.clustered;
  parameters["clustering"] = clustering.method == ClusterMethod::tree ? "tree" : "k-means";
  parameters["clusters"] = clustering.clusters;
  parameters["levels"] = options.levels;
  parameters["metric"] = clustering.metric == ClusterMetric::cosine ? "cosine" : "euclidean";
  parameters["refine_codebooks"] = options.refine_codebooks;
  parameters["refit_scale"] = options.refit_scale;
  parameters["resolution"] = options.resolution;
  parameters["seed"] = clustering.seed;
  parameters["weighted"] = options.weighted;
}

FittedMaps::FittedMaps(Eigen::Index texels, Eigen::Index values, bool in_halfs,
                       const std::shared_ptr<MemoryBudget>& memory)
    : texels_(texels), values_(values), memory_(memory) {
  if (in_halfs)
    halfs_ = LargeArray<Imath::half>(static_cast<std::size_t>(texels * values), memory);
  else
    floats_ = LargeRows(texels, values, memory);
}

void FittedMaps::set_row(Eigen::Index texel, std::span<const float> values) {
  if (halfs_.size() == 0)
    std::ranges::copy(values, floats_.matrix().row(texel).data());
  else
    std::ranges::copy(values, halfs_.data() + texel * values_);
}

LargeRows FittedMaps::taken_rows() {
  if (halfs_.size() == 0) return std::move(floats_);
  LargeRows rows(texels_, values_, memory_);
  tbb::parallel_for(Eigen::Index{0}, texels_, [&](Eigen::Index texel) {
    std::copy_n(halfs_.data() + texel * values_, values_, rows.matrix().row(texel).data());
  });
  halfs_ = {};
  return rows;
}

FittedFactors::FittedFactors(const TexelSource& source, const StorageOptions& options)
    : scale(3 * source.size(), 1.0F),
      resolution(options.resolution),
      in_halfs(options.eight_bit),
      memory(source.finest().memory()) {}

void FittedFactors::add(Projection projection, int terms) {
  const auto texels = static_cast<Eigen::Index>(scale.size() / 3);
  const Eigen::Index values = Eigen::Index{3} * terms * resolution * resolution;
  factors.push_back({projection, terms, FittedMaps(texels, values, in_halfs, memory)});
}

void store(const LaneVector& maps, std::span<const std::size_t> texels, std::size_t factor,
           FittedFactors& fitted) {
  std::vector<float> row(3 * maps.size());
  for (int k = 0; k < 3 * static_cast<int>(texels.size()); ++k) {
    float largest = 0;
    for (const Lanes& value : maps) largest = std::max(largest, std::abs(value[k]));
    const std::size_t texel = texels[k / 3];
    for (std::size_t t = 0; t < maps.size(); ++t) {
      row[3 * t + k % 3] = largest > 0 ? maps[t][k] / largest : 0.0F;
    }
    fitted.scale[3 * texel + k % 3] *= largest;
    if (k % 3 == 2) fitted.factors[factor].maps.set_row(static_cast<Eigen::Index>(texel), row);
  }
}

namespace {

ValueArray value_array(std::span<const float> values, bool eight_bit) {
  if (eight_bit) return {to_bytes(values), {}};
  return {{}, {values.begin(), values.end()}};
}

// Of each texel the sum of B^2. An error of a map that is a share x of it makes about x^2 of that.
std::vector<double> energies(const TexelSource& source) {
  const std::size_t values = 3 * source.finest().lights().size() * source.finest().views().size();
  std::vector<double> energy(source.size());
  tbb::parallel_for(std::size_t{0}, energy.size(), [&](std::size_t t) {
    std::vector<float> abrdf(values);
    source.abrdf(t, abrdf);
    for (const float b : abrdf) energy[t] += static_cast<double>(b) * b;
  });
  return energy;
}

// A codebook's maps divided by their largest magnitude in each channel, which the scale takes.
void normalise(std::size_t factor, Model& model, std::vector<float>& scale) {
  std::vector<float>& values = model.factors[factor].maps.floats;
  const std::size_t maps = model.map_count(factor);
  const std::size_t map = values.size() / maps;
  std::vector<float> largest(3 * maps);
  for (std::size_t i = 0; i < values.size(); ++i) {
    float& own = largest[3 * (i / map) + i % 3];
    own = std::max(own, std::abs(values[i]));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float divisor = largest[3 * (i / map) + i % 3];
    if (divisor > 0) values[i] /= divisor;
  }
  for (std::size_t i = 0; i < scale.size(); ++i)
    scale[i] *= largest[3 * model.map_of(factor, i / 3) + i % 3];
}

// `energy`: empty where all texels count alike.
// Section 5: a codebook of prototypes and an index map a factor, RGB and terms jointly.
void cluster_factor(LargeRows maps, const std::vector<double>& energy, std::size_t factor,
                    const StorageOptions& options, Model& model, std::vector<float>& scale,
                    Progress& progress) {
  progress.start(max_k_means_iterations, "iterations");
  std::vector<double> weights(model.texels(), 1.0);
  for (std::size_t t = 0; t < energy.size(); ++t) {
    const double square = maps.matrix().row(static_cast<Eigen::Index>(t)).squaredNorm();
    weights[t] = square > 0 ? energy[t] / square : 0.0;
  }
  ClusterOptions clustering = options.clustering;
  clustering.seed += factor;
  const Codebook book = cluster(std::move(maps), std::move(weights), clustering, progress);
  const RowMatrix& prototypes = book.clustering.prototypes;
  model.factors[factor].maps =
      value_array({prototypes.data(), static_cast<std::size_t>(prototypes.size())}, false);
  const std::size_t channels = model.index_channels();
  for (std::size_t texel = 0; texel < model.texels(); ++texel) {
    model.index[channels * texel + factor] =
        static_cast<std::uint8_t>(book.clustering.index[texel]);
    for (std::size_t c = 0; c < 3; ++c) scale[3 * texel + c] *= book.amplitude[texel];
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
    const float share = divisor > 0 ? std::max(scale[i], 0.0F) / divisor : 0;
    scale[i] = eight_bit ? std::sqrt(share) : share;
  }
  model.scale_max = largest;
  model.scale = value_array(scale, eight_bit);
}

}  // namespace

Model assemble(const TexelSource& source, FittedFactors fitted, const StorageOptions& options,
               const std::string& codec, const std::string& parameters, Progress& progress) {
  Model model{.codec = codec,
              .levels = source.levels(),
              .resolution = options.resolution,
              .clustered = options.clustered,
              .factors = {},
              .index = {},
              .rotation = std::move(fitted.rotation),
              .scale = {},
              .scale_max = Rgb(0, 0, 0),
              .views = source.finest().views(),
              .lights = source.finest().lights(),
              .parameters = parameters,
              .provenance = source.finest().provenance};
  for (const FittedFactor& factor : fitted.factors) {
    model.factors.push_back({factor.projection, factor.terms, {}});
  }
  if (options.clustered) model.index.resize(model.index_channels() * model.texels());
  const std::vector<double> energy =
      options.clustered && options.weighted ? energies(source) : std::vector<double>();
  for (std::size_t f = 0; f < fitted.factors.size(); ++f) {
    LargeRows maps = fitted.factors[f].maps.taken_rows();  // freed at the end of its turn
    if (options.clustered)
      cluster_factor(std::move(maps), energy, f, options, model, fitted.scale, progress);
    else
      model.factors[f].maps = value_array(maps.values(), options.eight_bit);
  }
  if (options.refine_codebooks > 0)
    refine_codebooks(source, options.refine_codebooks, model, progress);
  if (options.clustered) {
    for (std::size_t f = 0; f < model.factors.size(); ++f) {
      normalise(f, model, fitted.scale);
      const std::vector<float> maps = std::move(model.factors[f].maps.floats);
      model.factors[f].maps = value_array(maps, options.eight_bit);
    }
  }
  std::vector<float> scale =
      options.refit_scale ? least_squares_scale(source, model) : std::move(fitted.scale);
  store_scale(std::move(scale), options.eight_bit, model);
  progress.finish();
  return model;
}

}  // namespace weft::factor_maps
