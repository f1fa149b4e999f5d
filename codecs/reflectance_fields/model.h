// A BTF as one function of the light for each measured view and texel (paper 003, section 4.2),
// what the codecs `lobes` and `ptm` share: files, decoder and GLSL. The very arrays that the GPU
// gets.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "codecs/fitted_folder.h"
#include "codecs/stored_values.h"

namespace weft::reflectance_fields {

/// What a field's numbers are, four a texel of the texture:
/// `lobes`             (w, n) a lobe, then the colour: RGB times the sum of |w| (<w, l> / |w|)^n;
///                     (a, b, c) = |w|^(1/n - 1) w of the paper's equation 1
/// `luminance`         x^2, y^2, xy, x | y, 1, 0, 0 | colour: RGB times the polynomial of the light
/// `luminance_cosine`  likewise, times cos(theta_light)
/// `rgb`               a texel of RGB for each of x^2, y^2, xy, x, y, 1
/// `rgb_cosine`        likewise, times cos(theta_light)
/// <., .> and polynomials below zero are zero.
enum class Kind { lobes, luminance, luminance_cosine, rgb, rgb_cosine };

std::string name_of(Kind kind);
inline bool is_rgb(Kind kind) {
  return kind == Kind::rgb || kind == Kind::rgb_cosine;
}
inline bool has_cosine(Kind kind) {
  return kind == Kind::luminance_cosine || kind == Kind::rgb_cosine;
}

struct Model {
  std::string codec{};  ///< "lobes" or "ptm"
  FittedHead head;
  Storage storage = Storage::half;  ///< or float
  Kind kind = Kind::lobes;
  std::size_t lobes = 0;        ///< 1 to 4 where the kind is `lobes`
  std::vector<float> fields{};  ///< [view][texel][quads()][4], stored
  float scale = 1;              ///< 1/sr; times the colour, or times the polynomials of RGB

  std::size_t quads() const { return kind == Kind::lobes ? lobes + 1 : is_rgb(kind) ? 6 : 3; }
  std::size_t floats_a_field() const { return 4 * quads(); }
  std::size_t bytes() const { return fields.size() * bytes_a_value(storage); }
};

/// What a fit of three quads a field takes for each: the model, the picture that is written, what a
/// view's checkpoint holds, and half as much again.
constexpr std::size_t fit_bytes_a_field = 224;

/// A model of zeros.
Model empty_model(const Btf& btf, const std::string& codec, Kind kind, std::size_t lobes,
                  Storage storage, const std::string& parameters);

/// Sets `scale` so that the largest of `fields`' colours (or polynomials of RGB) is 8,192, divides
/// by it, and rounds all. The last step. Then halfs hold not only what is stored but also, for
/// `lobes`, every intermediate value of a decoder that takes |w| of w over its largest component:
/// four lobes of at most 1.2, times a colour.
/// @throws Error  bad_input that names the first view and texel of more than a float holds.
void store_fields(Model& model);

void write_model(const std::filesystem::path& folder, const Model& model);
/// @throws Error  as `read_fitted`.
Model read_model(const std::filesystem::path& folder, const std::string& codec);

}  // namespace weft::reflectance_fields
