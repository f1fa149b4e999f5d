// A decorrelated full-matrix factorisation: log-luminance and two chromas, each a sum of products
// of a number of the pair and one of the texel. The very arrays that the GPU gets.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "codecs/fitted_folder.h"
#include "codecs/stored_values.h"

namespace weft::dfmf {

/// a, b, c of (texel, pair) are sums over their slots of scale[slot] weights[texel][slot]
/// basis[pair][slot]; then f = B / cos(theta_light) is
///   Y = epsilon (exp(a) - 1), U = b (Y + epsilon), V = c (Y + epsilon), in RGB.
/// Each channel's slots begin a texel of four; those without a component are zero.
struct Model {
  FittedHead head;
  Storage storage = Storage::half;
  std::array<std::size_t, 3> components{16, 8, 8};
  float epsilon = 1;             ///< 1/sr
  std::vector<float> weights{};  ///< [texel][slot], stored, the largest of a slot 1
  std::vector<float> basis{};    ///< [view][light][slot], stored, likewise
  std::vector<float> scale{};    ///< [slot]

  std::size_t first_slot(std::size_t channel) const {
    std::size_t slot = 0;
    for (std::size_t c = 0; c < channel; ++c) slot += (components[c] + 3) / 4 * 4;
    return slot;
  }
  std::size_t slots() const { return first_slot(3); }
  std::size_t bytes() const { return (weights.size() + basis.size()) * bytes_a_value(storage); }
};

void write_model(const std::filesystem::path& folder, const Model& model);
/// @throws Error  as `read_fitted`.
Model read_model(const std::filesystem::path& folder);

}  // namespace weft::dfmf
