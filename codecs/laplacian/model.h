// What a fitted Laplacian BTF is made of: eigen Laplacian BRDFs and PCA weights of each level, and
// the model of the top's mean. As texels, the paper's two maps.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "codecs/fitted_folder.h"
#include "codecs/laplacian/phong.h"
#include "codecs/laplacian/pyramid.h"
#include "codecs/stored_values.h"

namespace weft::laplacian {

/// How the chroma of the top's mean is told: equation 6, or times the light's cosine.
enum class ChromaMean { constant, cosine };

struct Texel {
  int x;
  int y;
};

/// Slots are components, of Y, then of Cb, then of Cr, four to a texel of the maps (a quad); Cb
/// begins a quad. Those without a component are zero.
struct Model {
  FittedHead head;
  Storage storage = Storage::float32;
  Pyramid pyramid{};
  std::array<std::size_t, 3> components{8, 2, 2};  ///< of Y, Cb, Cr at every level
  bool interpolated = false;  ///< between directions; otherwise the nearest sampled ones
  Phong mean_y{};
  ChromaMean chroma = ChromaMean::constant;
  std::array<float, 2> mean_chroma{};  ///< c of equation 6, of Cb and Cr

  std::vector<float> eigen{};    ///< [level][view][light][slot], stored, the largest of a slot 1
  std::vector<float> weights{};  ///< [level][texel][slot], stored, likewise
  std::vector<float> scale{};    ///< [level][slot], 1/sr

  int levels() const { return pyramid.top + 1; }
  std::size_t luma_quads() const { return (components[0] + 3) / 4; }
  std::size_t quads() const { return luma_quads() + (components[1] + components[2] + 3) / 4; }
  std::size_t slots() const { return 4 * quads(); }
  std::size_t first_slot(std::size_t channel) const {
    return channel == 0 ? 0 : channel == 1 ? 4 * luma_quads() : 4 * luma_quads() + components[1];
  }
  /// Rows of `weights` before a level's.
  std::size_t first_weight_row(int level) const;

  // Section 3.3. The eigen map is quads p x levels q texels, p lights and q views. The weight map
  // of three quads is the paper's square of 2 r x 2 r: three blocks a level, the next level's in
  // the fourth quarter. Other numbers of quads lie side by side, level 0 above all others.
  Texel eigen_map_size() const;
  Texel weight_map_size() const;
  /// First texel of a level's block.
  Texel weight_block(int level, std::size_t quad) const;
  std::size_t bytes() const;
  std::vector<float> eigen_map() const;
  std::vector<float> weight_map() const;
  void set_maps(const std::vector<float>& eigen_map, const std::vector<float>& weight_map);
};

void write_model(const std::filesystem::path& folder, const Model& model);
/// @throws Error  as `read_fitted`.
Model read_model(const std::filesystem::path& folder);

}  // namespace weft::laplacian
