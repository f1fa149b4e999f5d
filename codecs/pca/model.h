// Eigen-ABRDFs and each texel's weights: of all views together (`pca`), or of each view alone
// (`pca-view`). The very arrays that the GPU gets.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "codecs/fitted_folder.h"
#include "codecs/stored_values.h"

namespace weft::pca {

/// B(texel, light, view) = mean_scale mean[pair] + sum over k of
///                         scale[set][k] weights[set][texel][k] basis[pair][rgb][k],
/// set = 0, or the view's. Components beyond `components` are zero and fill a texel of the GPU.
struct Model {
  std::string codec{};  ///< "pca" or "pca-view"
  FittedHead head;
  Storage storage = Storage::half;
  std::size_t components = 0;
  std::size_t sets = 1;          ///< of weights: 1, or one a view
  std::vector<float> weights{};  ///< [set][texel][padded()], stored, the largest of a component 1
  std::vector<float> basis{};    ///< [view][light][rgb][padded()], stored, likewise
  std::vector<float> mean{};     ///< [view][light][4], stored, the fourth 0
  std::vector<float> scale{};    ///< [set][padded()], 1/sr
  float mean_scale = 0;          ///< 1/sr

  /// A multiple of four.
  std::size_t padded() const { return (components + 3) / 4 * 4; }
  /// 8 bits would leave the mean's dark samples none.
  Storage mean_storage() const { return storage == Storage::eight_bit ? Storage::half : storage; }
  std::size_t bytes() const {
    return (weights.size() + basis.size()) * bytes_a_value(storage) +
           mean.size() * bytes_a_value(mean_storage());
  }
};

void write_model(const std::filesystem::path& folder, const Model& model);
/// @throws Error  as `read_fitted`.
Model read_model(const std::filesystem::path& folder, const std::string& codec);

}  // namespace weft::pca
