// Fitted kernels that can be evaluated at any level of detail, saved and given to the GPU.
#pragma once

#include <array>
#include <vector>

#include "codecs/representation.h"
#include "codecs/srbf/model.h"
#include "codecs/stencil_batch.h"

namespace weft::srbf {

/// How a decoder's texel lies in memory: [wide][slot][lane], [quad][slot][4], then the angles, or
/// their cosines and sines where no numbers are blended.
struct RowPlaces {
  std::size_t wides;      ///< groups of as many kernels as the CPU has lanes
  std::size_t narrows;    ///< and, of the rest, groups of four
  std::size_t angles_at;  ///< the first of them
  std::size_t size;       ///< numbers, a multiple of the lanes
};

/// The texels that a query blends, and how.
struct Rows {
  std::size_t count;  ///< 4, or 8 of two levels
  std::array<const float*, 8> row;
  std::array<float, 8> weight;
};

class SrbfRepresentation : public Representation {
 public:
  explicit SrbfRepresentation(Model model);

  using Appearance::evaluate;
  /// Blends what four texels' kernels sum up to, of two levels where lod lies between, or, as the
  /// model's filtering says, their numbers, and sums up once; sums below 0 become 0. There is no
  /// table of directions.
  Rgb evaluate(Texcoord uv, Direction light, Direction view, float lod) const override;
  void evaluate(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const override;
  bool has_lod() const override { return true; }
  Imath::V2i texels() const override { return {model_.head.width, model_.head.height}; }

  std::size_t bytes() const override { return model_.bytes(); }
  std::size_t constant_bytes() const override { return model_.scale.size() * sizeof(float); }
  const HemisphereSampling& views() const override { return model_.head.views; }
  const HemisphereSampling& lights() const override { return model_.head.lights; }
  std::string codec() const override { return "srbf"; }
  void save(const std::filesystem::path& folder) const override;
  GlProgram gl_program() const override;

  const Model& model() const { return model_; }

 private:
  std::vector<std::byte> filtered_bytes() const;
  void fill_row(std::size_t texel);
  Rows rows_around(Texcoord uv, float lod) const;
  template <std::size_t K, Filtering filtering>
  Rgb decode(const Rows& rows, const Rows& next, const Direction& light,
             const Direction& view) const;
  template <std::size_t K, Filtering filtering>
  void decode_all(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const;
  template <std::size_t K>
  void decode_modes(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const;

  Model model_;
  RowPlaces places_;
  // [level][texel], times scale.
  AlignedFloats rows_;
  std::vector<std::size_t> first_texel_;  // of each level
};

}  // namespace weft::srbf
