// A Lafortune model a texel: a diffuse term and lobes over light and view together. The very array
// that the GPU gets.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "codecs/fitted_folder.h"
#include "codecs/stored_values.h"

namespace weft::lafortune {

/// B(texel, l, v) = cos(theta_light) colour[texel] (diffuse + sum over lobes of
///                  P max(Cx lx vx + Cy ly vy + Cz lz vz, 0)^n / P^n),   P = max |C|.
/// A texel's numbers: (C, n) a lobe, then colour in RGB and diffuse. So P is the lobe's peak over
/// all directions, and the paper's own coefficients are P^(1/n - 1) C.
struct Model {
  FittedHead head;
  Storage storage = Storage::half;  ///< or float
  std::size_t lobes = 2;            ///< 1 to 3
  std::vector<float> texels{};      ///< [texel][lobes + 1][4], stored
  float scale = 1;                  ///< 1/sr; times the colour

  std::size_t quads() const { return lobes + 1; }
  std::size_t bytes() const { return texels.size() * bytes_a_value(storage); }
};

void write_model(const std::filesystem::path& folder, const Model& model);
/// @throws Error  as `read_fitted`.
Model read_model(const std::filesystem::path& folder);

}  // namespace weft::lafortune
