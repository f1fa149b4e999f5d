// A fitted DFMF that can be evaluated, saved and given to the GPU.
#pragma once

#include "btf/raw_appearance.h"
#include "codecs/dfmf/model.h"
#include "codecs/representation.h"
#include "codecs/stencil_batch.h"

namespace weft::dfmf {

class DfmfRepresentation : public Representation {
 public:
  explicit DfmfRepresentation(Model model);

  using Appearance::evaluate;
  /// Decodes four texels at three views and three lights to RGB, and blends those: blended before
  /// the exponential, an edge between bright and dark would darken. Level 0 answers for every lod.
  Rgb evaluate(Texcoord uv, Direction light, Direction view, float lod) const override;
  void evaluate(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const override;
  bool has_lod() const override { return false; }
  Imath::V2i texels() const override { return {model_.head.width, model_.head.height}; }

  std::size_t bytes() const override { return model_.bytes(); }
  std::size_t constant_bytes() const override;
  const HemisphereSampling& views() const override { return model_.head.views; }
  const HemisphereSampling& lights() const override { return model_.head.lights; }
  std::string codec() const override { return "dfmf"; }
  void save(const std::filesystem::path& folder) const override;
  GlProgram gl_program() const override;

 private:
  Rgb decode(const TexelStencil& texels, const PairLane& neighbours) const;
  void fetch(const TexelStencil& texels, const PairLane& neighbours) const;

  Model model_;
  BatchLocator view_locator_;
  BatchLocator light_locator_;
  std::vector<float> ones_;  // for each light
  AlignedFloats basis_;      // [view][light][slot], times scale
};

}  // namespace weft::dfmf
