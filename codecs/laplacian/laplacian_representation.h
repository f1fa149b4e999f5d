// A fitted Laplacian BTF that can be evaluated at any level of detail, saved and given to the GPU.
#pragma once

#include <array>

#include "codecs/laplacian/model.h"
#include "codecs/nearest_table.h"
#include "codecs/representation.h"
#include "codecs/stencil_batch.h"

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
  Pairs weighted_pairs(const Stencil& lights, const Stencil& views, float cosine) const;
  std::array<Pairs, batch_lanes> pairs_of(const std::array<Direction, batch_lanes>& light,
                                          const std::array<Direction, batch_lanes>& view) const;
  Place place_of(Texcoord uv, float lod) const;
  template <std::size_t Quads>
  void add_level(int level, const Blend& blend, const Pairs& pairs, float* sum) const;
  template <std::size_t Quads>
  void add_boxes(const Corners& c, int grid, float weight, const Pairs& pairs, float* sum) const;
  template <std::size_t Quads>
  void add_levels(Texcoord uv, const Place& place, const Pairs& pairs, float* sum) const;
  Rgb decode(const AppearanceQuery& query, const Place& place, const Pairs& pairs,
             float mean_y) const;

  Model model_;
  BatchLocator view_locator_;
  BatchLocator light_locator_;
  NearestTable nearest_view_;
  NearestTable nearest_light_;
  std::vector<std::size_t> first_row_;  // of each level, in the model's weights
  std::vector<float> weights_;          // the model's, four more behind them
  std::vector<float> eigen_;            // [view][light][level][slot], times scale; interpolated
                                        // ones over cos(theta_light)
};

}  // namespace weft::laplacian
