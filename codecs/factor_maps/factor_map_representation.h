// Fitted factor maps that can be evaluated, saved and given to the GPU.
#pragma once

#include <utility>

#include "codecs/factor_maps/decode.h"
#include "codecs/factor_maps/model.h"
#include "codecs/representation.h"

namespace weft::factor_maps {

class FactorMapRepresentation : public Representation {
 public:
  explicit FactorMapRepresentation(Model model) : model_(std::move(model)), decoder_(model_) {}
  FactorMapRepresentation(const FactorMapRepresentation&) = delete;  // the decoder points into it
  FactorMapRepresentation& operator=(const FactorMapRepresentation&) = delete;

  /// Decodes the four texels around uv and blends (paper 004, section 7), linearly between levels.
  Rgb evaluate(Texcoord uv, Direction light, Direction view, float lod) const override;
  /// To a few units in the last place the same.
  void evaluate(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const override;
  bool has_lod() const override { return model_.levels.size() > 1; }
  Imath::V2i texels() const override { return {model_.width(), model_.height()}; }

  std::size_t bytes() const override;
  std::size_t constant_bytes() const override { return sizeof(model_.scale_max); }
  const HemisphereSampling& views() const override { return model_.views; }
  const HemisphereSampling& lights() const override { return model_.lights; }
  std::string codec() const override { return model_.codec; }
  void save(const std::filesystem::path& folder) const override;
  /// @throws Error  where unclustered maps are more than one texture of the GPU holds.
  GlProgram gl_program() const override;

  const Model& model() const { return model_; }

 private:
  Model model_;
  Decoder decoder_;
};

}  // namespace weft::factor_maps
