// From a model to values: bilinear lookups in the maps of the four texels around uv, multiplied.
//
// What does not depend on the texel (where the directions lie in the maps) is reckoned once a
// query, and for sixteen queries at a time where many are asked; where texels are turned, for the
// four of them side by side.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "btf/appearance.h"
#include "codecs/factor_maps/map_places.h"
#include "codecs/factor_maps/model.h"
#include "codecs/factor_maps/texel_pairs.h"
#include "codecs/stencil_batch.h"
#include "codecs/wide_vector.h"

namespace weft::factor_maps {

/// By factor; only those of the model's are set.
using MapPlaces = std::array<MapPlace, max_factors>;

/// A rotation about the normal.
struct Turn {
  float cosine;
  float sine;
};

/// Decodes one model, which must outlive it and keep its arrays where they are.
class Decoder {
 public:
  explicit Decoder(const Model& model);

  /// Product of a texel's links, without cosine; its scale is 1 where the model has none yet.
  Rgb value(std::size_t texel, const MapPlaces& places) const;
  /// Of a pair of directions with z > 0, turned back by `rotation` steps.
  MapPlaces places(const Direction& light, const Direction& view, int rotation) const;

  Rgb evaluate(const Texcoord& uv, const Direction& light, const Direction& view, float lod) const;
  void evaluate(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const;

 private:
  /// What a texel knows, in half a cache line: its scale with the bytes' 1 / 255 in it, by how many
  /// steps it is turned (a float too: as a whole number it would be a subnormal one in the fourth
  /// lane of sums, and slow), and the number of its first map of each factor.
  struct alignas(32) Texel {
    Vec4 scale_and_steps;
    std::array<std::uint32_t, max_factors> map;
  };
  Turn turn_back(int steps) const { return {turn_back_cosine_[steps], turn_back_sine_[steps]}; }
  template <typename Value>
  Vec4 product(const Value* const* maps, const Texel& texel, const MapPlaces& places) const;
  Vec4 texel_value(std::size_t texel, const MapPlaces& places) const;
  template <typename Texels, typename LookUp>
  Vec4 plain_sum(const Texels& texels, const LookUp& look_up) const;
  Vec4 level_value(const Level& level, const Texcoord& uv, const MapPlaces& places) const;
  Vec4 turned_level_value(const Level& level, const Texcoord& uv, const Direction& light,
                          const Direction& view) const;

  std::array<PlaneLanes, max_factors> images(const QueryBatch& batch) const;
  TexelBatch level_texels(const QueryBatch& batch, const Batch<std::int32_t>& levels,
                          const Batch<float>& share) const;
  void add_level(const TexelBatch& texels, const std::array<PlaneLanes, max_factors>& images,
                 Batch<Vec4>& sums) const;
  void add_turned_level(const TexelBatch& texels, const std::array<PlaneLanes, max_factors>& images,
                        Batch<Vec4>& sums) const;
#ifdef __AVX512F__
  void add_level_of_pairs(const TexelBatch& texels,
                          const std::array<PlaneLanes, max_factors>& images, RgbLanes& sums) const;
  Batch<Rgb> decode_pairs(const QueryBatch& batch) const;
#endif
  Batch<Rgb> decode(const QueryBatch& batch) const;

  const Model& model_;
  bool single_terms_ = true;
  bool plain_ = false;  // light, half, view of one term: asked for most, and written out
  bool has_difference_ = false;
  std::size_t map_values_ = 0;  // of one term
  std::size_t row_values_ = 0;  // of a map
  std::array<const std::uint8_t*, max_factors> bytes_{};
  std::array<const float*, max_factors> floats_{};
  std::array<std::vector<TexelPair>, 3> pairs_;  // of plain codebooks of bytes
  std::vector<Texel> texels_;
  std::vector<Turn> turns_;  // of each texel, for single queries; none where none is turned
  alignas(64) std::array<float, rotation_steps> turn_back_cosine_;
  alignas(64) std::array<float, rotation_steps> turn_back_sine_;
};

}  // namespace weft::factor_maps
