// A fitted PCA, of all views or of each, that can be evaluated, saved and given to the GPU.
#pragma once

#include <array>

#include "btf/raw_appearance.h"
#include "codecs/pca/model.h"
#include "codecs/representation.h"
#include "codecs/stencil_batch.h"

namespace weft::pca {

class PcaRepresentation : public Representation {
 public:
  explicit PcaRepresentation(Model model);

  using Appearance::evaluate;
  /// Blends the weights of four texels and f = B / cos(theta_light) of the bases over three views
  /// and three lights, as the raw BTF is interpolated; both are linear, so that nothing but the
  /// components left out, rounding, and values below 0, which become 0, differ from it. Level 0
  /// answers for every lod.
  Rgb evaluate(Texcoord uv, Direction light, Direction view, float lod) const override;
  /// Sixteen at a time: their stencils side by side.
  void evaluate(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const override;
  bool has_lod() const override { return false; }
  Imath::V2i texels() const override { return {model_.head.width, model_.head.height}; }

  std::size_t bytes() const override { return model_.bytes(); }
  std::size_t constant_bytes() const override;
  const HemisphereSampling& views() const override { return model_.head.views; }
  const HemisphereSampling& lights() const override { return model_.head.lights; }
  std::string codec() const override { return model_.codec; }
  void save(const std::filesystem::path& folder) const override;
  GlProgram gl_program() const override;

  const Model& model() const { return model_; }

 private:
  template <typename Row>
  Batch<Rgb> decode(const QueryBatch& batch) const;
  template <typename Row>
  Rgb decode(const TexelStencil& texels, const PairLane& pairs) const;

  Model model_;
  BatchLocator view_locator_;
  BatchLocator light_locator_;
  std::vector<float> inverse_cosines_;  // of the lights
  std::size_t lanes_;                   // components a row below, eight or a multiple of sixteen
  AlignedFloats weights_;               // [set][texel][lanes_]
  AlignedFloats basis_;                 // [view][light][rgb][lanes_], times scale
  AlignedFloats mean_;                  // [view][light][4]
};

}  // namespace weft::pca
