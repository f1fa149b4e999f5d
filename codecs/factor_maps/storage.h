// How fitted maps become a model: normalised, clustered, rounded, and the scale solved again (paper
// 004, sections 5 and 6). The same for every codec of factor maps.
#pragma once

#include <half.h>

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "btf/progress.h"
#include "codecs/factor_maps/clustering.h"
#include "codecs/factor_maps/model.h"
#include "codecs/factor_maps/texel_source.h"
#include "settings/settings.h"

namespace weft::factor_maps {

struct StorageOptions {
  bool eight_bit = true;     ///< textures of 8 bits, otherwise float
  bool clustered = true;     ///< codebooks and index maps, otherwise every texel's own maps
  bool levels = true;        ///< mip levels too
  bool refit_scale = true;   ///< solve the scale map again once the maps are what the GPU gets
  bool weighted = true;      ///< clustering weighs texels by their energy, not each alike
  int refine_codebooks = 0;  ///< rounds of `refine_codebooks`; needs refit_scale and one term
  int resolution = 32;       ///< texels a side of each map
  ClusterOptions clustering;
};

/// Reads the keys of `storage_help`. @throws Error  for a value out of range.
/// @param refine_codebooks  its default, where the scale is refitted.
StorageOptions storage_options(const Settings& parameters, int refine_codebooks = 0);
/// Lines "name = default   meaning".
std::string storage_help(int refine_codebooks = 0);
/// Adds every parameter.
void add_to(nlohmann::json& parameters, const StorageOptions& options);

/// One factor's maps of all texels, a row a texel of any level: [term][row][column][rgb]. What ends
/// in 8 bits is kept in halfs (11 bits): with floats, maps and data would be three times the data.
class FittedMaps {
 public:
  FittedMaps(Eigen::Index texels, Eigen::Index values, bool in_halfs,
             const std::shared_ptr<MemoryBudget>& memory);

  /// @param values  -1..1. Thread-safe for different texels.
  void set_row(Eigen::Index texel, std::span<const float> values);
  /// All of it in floats, which takes the place of what is here.
  LargeRows taken_rows();

 private:
  Eigen::Index texels_;
  Eigen::Index values_;
  std::shared_ptr<MemoryBudget> memory_;
  LargeRows floats_;
  LargeArray<Imath::half> halfs_;
};

struct FittedFactor {
  Projection projection = Projection::light;
  int terms = 1;
  FittedMaps maps;
};

struct FittedFactors {
  FittedFactors(const TexelSource& source, const StorageOptions& options);
  void add(Projection projection, int terms);

  std::vector<FittedFactor> factors;
  std::vector<float> scale;            ///< [texel][rgb]: what the maps were divided by
  std::vector<std::uint8_t> rotation;  ///< as `Model::rotation`
  int resolution;
  bool in_halfs;
  std::shared_ptr<MemoryBudget> memory;  ///< the data's
};

/// Writes a block's maps of one factor, [term][row][column] in lanes, as rows, each channel divided
/// by its largest magnitude, which multiplies `fitted.scale`. Thread-safe for different texels.
void store(const LaneVector& maps, std::span<const std::size_t> texels, std::size_t factor,
           FittedFactors& fitted);

/// Clusters, rounds and solves the scale. Frees `fitted` on the way.
Model assemble(const TexelSource& source, FittedFactors fitted, const StorageOptions& options,
               const std::string& codec, const std::string& parameters, Progress& progress);

}  // namespace weft::factor_maps
