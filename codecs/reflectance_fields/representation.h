// Reflectance fields that can be evaluated, saved and given to the GPU.
#pragma once

#include "btf/vector.h"
#include "codecs/reflectance_fields/model.h"
#include "codecs/representation.h"
#include "codecs/ring_stencil.h"
#include "codecs/wide_vector.h"

namespace weft::reflectance_fields {

class FieldRepresentation : public Representation {
 public:
  explicit FieldRepresentation(Model model);
  FieldRepresentation(const FieldRepresentation&) = delete;  // points into itself
  FieldRepresentation& operator=(const FieldRepresentation&) = delete;

  using Appearance::evaluate;
  /// Blends the values of the fields of four texels and the four views around `view`
  /// (`RingStencil`; three where the views are in no rings), each as the light finds it: lights are
  /// not interpolated. Level 0 answers for every lod.
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
  template <typename Number>
  struct Fields;
  template <typename Number>
  Fields<Number> fields(const std::vector<const Number*>& of_view, const TexelStencil& texels,
                        const StencilLane& views) const;
  template <typename Number>
  Vec4 polynomials_of_rgb(const std::vector<const Number*>& of_view, const TexelStencil& texels,
                          const StencilLane& views, const Direction& light) const;
  template <typename Number>
  Vec4 luminances(const Fields<Number>& fields, const Direction& light) const;
  template <typename Number>
  Rgb decode(const std::vector<const Number*>& of_view, const TexelStencil& texels,
             const StencilLane& views, const Direction& light) const;
  template <typename Number>
  Batch<Rgb> decode(const std::vector<const Number*>& of_view, const QueryBatch& batch) const;

  Model model_;
  RingStencil view_stencil_;
  std::vector<half> halfs_;  // the model's fields where they are stored so: half the memory to read
  // Where each view's fields begin, in `halfs_` or in the model.
  std::vector<const half*> half_views_;
  std::vector<const float*> float_views_;
};

}  // namespace weft::reflectance_fields
