// A fitted CMF that can be evaluated, saved and given to the GPU.
#pragma once

#include "codecs/cmf/model.h"
#include "codecs/representation.h"

namespace weft::cmf {

class CmfRepresentation : public Representation {
 public:
  explicit CmfRepresentation(Model model) : model_(std::move(model)) {}

  using Appearance::evaluate;
  /// Decodes the four texels around uv and blends (the paper's section 7); level 0 answers for
  /// every lod.
  Rgb evaluate(Texcoord uv, Direction light, Direction view, float lod) const override;
  bool has_lod() const override { return false; }
  Imath::V2i texels() const override { return {model_.width, model_.height}; }

  std::size_t bytes() const override;
  std::size_t constant_bytes() const override { return sizeof(model_.scale_max); }
  const HemisphereSampling& views() const override { return model_.views; }
  const HemisphereSampling& lights() const override { return model_.lights; }
  std::string codec() const override { return "cmf"; }
  void save(const std::filesystem::path& folder) const override;
  /// @throws Error  where unclustered maps are more than one texture of the GPU holds.
  GlProgram gl_program() const override;

  const Model& model() const { return model_; }

 private:
  Model model_;
};

}  // namespace weft::cmf
