// A fitted Laplacian BTF that can be evaluated at any level of detail, saved and given to the GPU.
#pragma once

#include <array>

#include "codecs/laplacian/model.h"
#include "codecs/nearest_table.h"
#include "codecs/representation.h"
#include "codecs/stencil_batch.h"
#include "codecs/wide_vector.h"

namespace weft::laplacian {

/// Columns and rows of the four texels around uv.
struct Corners {
  std::array<int, 2> x;
  std::array<int, 2> y;
  std::array<float, 4> weight;
};

class LaplacianRepresentation : public Representation {
 public:
  explicit LaplacianRepresentation(Model model);

  using Appearance::evaluate;
  /// Equation 7, with lambda = lod clamped to the pyramid's levels. Weights are bilinear: with the
  /// box filters over the four texels of levels floor(lambda) and the next, each with its own
  /// parents, so that texel centres decode what was fitted there; with `linear` over each level's
  /// own. Values below 0 become 0.
  Rgb evaluate(Texcoord uv, Direction light, Direction view, float lod) const override;
  void evaluate(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const override;
  bool has_lod() const override { return true; }
  Imath::V2i texels() const override { return {model_.head.width, model_.head.height}; }

  std::size_t bytes() const override { return model_.bytes(); }
  std::size_t constant_bytes() const override;
  const HemisphereSampling& views() const override { return model_.head.views; }
  const HemisphereSampling& lights() const override { return model_.head.lights; }
  std::string codec() const override { return "laplacian"; }
  void save(const std::filesystem::path& folder) const override;
  GlProgram gl_program() const override;

  const Model& model() const { return model_; }

 private:
  struct Pairs;  // what of the eigen map is asked for
  struct Blend;  // which rows of a level's weights
  struct Place;  // level and texels
  Pairs nearest_pair(const Direction& light, const Direction& view) const;
  Pairs weighted_pairs(const PairLane& found) const;
  Batch<Pairs> pairs_of(const QueryBatch& batch) const;
  Place place_of(Texcoord uv, float lod) const;
  template <std::size_t Quads>
  void add_level(int level, const Blend& blend, const Pairs& pairs, float* sum) const;
  template <std::size_t Quads>
  void add_boxes(const Corners& c, int grid, float weight, const Pairs& pairs, float* sum) const;
  template <std::size_t Quads>
  void add_levels(Texcoord uv, const Place& place, const Pairs& pairs, float* sum) const;
  template <std::size_t Quads>
  Batch<Rgb> decode(const QueryBatch& batch) const;
  template <std::size_t Quads>
  std::array<Vec4, 3> channel_sums(const float* sum) const;
  Rgb colour(float y, float cb, float cr, float mean_y, float light_cosine) const;

  Model model_;
  BatchLocator view_locator_;
  BatchLocator light_locator_;
  NearestTable nearest_view_;
  NearestTable nearest_light_;
  std::vector<float> inverse_cosines_;          // of the lights
  std::array<AlignedFloats, 3> is_of_channel_;  // 1 in the slots of Y, of Cb, of Cr
  std::size_t stride_;                  // of the rows below, slots of which the last may be unused
  std::vector<std::size_t> first_row_;  // of each level, in the weights
  AlignedFloats weights_;               // [level][texel][stride_]
  AlignedFloats eigen_;                 // [view][light][level][stride_], times scale
};

}  // namespace weft::laplacian
