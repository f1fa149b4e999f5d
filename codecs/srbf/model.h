// What a fit leaves: the kernels of every texel of every mip level, as the GPU gets them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "codecs/fitted_folder.h"
#include "codecs/srbf/kernels.h"
#include "codecs/srbf/mip_levels.h"
#include "codecs/srbf/samples.h"
#include "codecs/stored_values.h"

namespace weft::srbf {

/// Where a texel's numbers lie: quads of four kernels side by side, each quad 3 K + 3 slots (p of
/// each mode, xyz; the colour, rgb), then one quad of angles.
struct Layout {
  Shape shape;

  std::size_t slots() const { return 3 * shape.modes + 3; }
  std::size_t groups() const { return (shape.kernels + 3) / 4; }
  std::size_t quads() const { return groups() * slots() + 1; }
  /// Of slot s of kernel j, in floats from the texel's first.
  std::size_t place(std::size_t j, std::size_t slot) const {
    return 4 * (j / 4 * slots() + slot) + j % 4;
  }
  std::size_t angle_place(std::size_t k) const { return 4 * groups() * slots() + k; }
};

/// What is blended between texels and levels: the kernels' sums, or their numbers, as a GPU's
/// filter does and the paper, which is faster and right where neighbours' numbers are alike.
enum class Filtering { values, numbers };
std::string name_of(Filtering filtering);

struct Model {
  FittedHead head;
  Storage storage = Storage::half;
  Shape shape{};
  Quantity quantity = Quantity::radiance;
  Filtering filtering = Filtering::values;
  std::vector<float> values{};  ///< [level][texel][quad][4], stored, over `scale`
  std::vector<float> scale{};   ///< [quad][4], the largest of all texels; colours in 1/sr
  std::string report = "{}";    ///< JSON: errors of each level, what fell back

  Layout layout() const { return {shape}; }
  MipSizes sizes() const { return {head.width, head.height}; }
  std::size_t row() const { return 4 * layout().quads(); }
  std::size_t texels() const { return sizes().first_texel(sizes().levels()); }
  std::size_t bytes() const { return values.size() * bytes_a_value(storage); }

  /// Fills values and scale.
  /// @param kernels  of every texel, level 0 first; colours times `colour_scale` are 1/sr.
  /// @throws Error   bad_input that names the first texel of more than a float holds.
  void set_kernels(const std::vector<Kernels>& kernels, double colour_scale);
};

void write_model(const std::filesystem::path& folder, const Model& model);
/// @throws Error  as `read_fitted`.
Model read_model(const std::filesystem::path& folder);

}  // namespace weft::srbf
