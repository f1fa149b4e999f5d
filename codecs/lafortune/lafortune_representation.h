// A fitted Lafortune model a texel that can be evaluated, saved and given to the GPU.
#pragma once

#include "codecs/lafortune/model.h"
#include "codecs/representation.h"

namespace weft::lafortune {

class LafortuneRepresentation : public Representation {
 public:
  explicit LafortuneRepresentation(Model model);

  using Appearance::evaluate;
  /// Blends the values of four texels; light and view are not interpolated. Level 0 answers for
  /// every lod.
  Rgb evaluate(Texcoord uv, Direction light, Direction view, float lod) const override;
  bool has_lod() const override { return false; }
  Imath::V2i texels() const override { return {model_.head.width, model_.head.height}; }

  std::size_t bytes() const override { return model_.bytes(); }
  std::size_t constant_bytes() const override { return 0; }
  const HemisphereSampling& views() const override { return model_.head.views; }
  const HemisphereSampling& lights() const override { return model_.head.lights; }
  std::string codec() const override { return "lafortune"; }
  void save(const std::filesystem::path& folder) const override { write_model(folder, model_); }
  GlProgram gl_program() const override;

  const Model& model() const { return model_; }

 private:
  Model model_;
  std::vector<float> texels_;  // as the model's; lobes are the paper's (Cx, Cy, Cz, n)
};

}  // namespace weft::lafortune
