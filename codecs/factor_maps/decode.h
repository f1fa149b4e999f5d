// From a model to values: bilinear lookups in the maps of the four texels around uv, multiplied.
//
// A lookup of three channels in two by two neighbouring texels of a map is one vector of sixteen
// floats: two loads, one multiplication and two folds. What does not depend
// on the texel (where the directions lie in the maps) is reckoned once a query, and for sixteen
// queries at a time where many are asked.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "btf/appearance.h"
#include "codecs/factor_maps/model.h"
#include "codecs/stencil_batch.h"
#include "codecs/wide_vector.h"

namespace weft::factor_maps {

/// Where a direction lies in a map: the upper left of its four texels, and how they blend.
struct MapPlace {
  std::uint32_t first;  ///< of the map's values, that texel's red
  Vec16 weight;         ///< of r g b r g b and two unused values from `first` on, and of two unused
                        ///< ones and r g b r g b of the row below
};
/// Only those of the model's factors are set.
using MapPlaces = std::array<MapPlace, max_factors>;

/// Where sixteen directions lie in a map, before their weights are spread.
struct PlaceLanes {
  alignas(64) Batch<std::int32_t> first;
  alignas(64) Batch<float> across;
  alignas(64) Batch<float> down;
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
  /// What a texel knows: its maps, and its scale with the bytes' 1 / 255 in it.
  struct Texel {
    Vec4 scale;
    std::array<std::uint32_t, max_factors> map;
  };
  template <typename Value>
  Vec4 product(const Value* const* maps, const Texel& texel, const MapPlaces& places) const;
  template <typename Value>
  Vec4 product_of_links(const Value* const* maps, const Texel& texel,
                        const MapPlaces& places) const;
  Vec4 value4(std::size_t texel, const MapPlaces& places) const;
  Rgb level_value(const Level& level, const Texcoord& uv, const Direction& light,
                  const Direction& view, const MapPlaces& places) const;
  std::array<PlaceLanes, max_factors> places(const QueryBatch& batch) const;
  TexelBatch level_texels(const QueryBatch& batch, const Batch<std::int32_t>& levels,
                          const Batch<float>& share) const;
  void add_level(const TexelBatch& texels, const std::array<PlaceLanes, max_factors>& places,
                 Batch<Vec4>& sums) const;
  template <typename Value>
  void add_plain(const Value* const* maps, const TexelBatch& texels,
                 const std::array<PlaceLanes, max_factors>& places, Batch<Vec4>& sums) const;
  Batch<Rgb> decode(const QueryBatch& batch) const;

  const Model& model_;
  bool single_terms_ = true;
  bool plain_ = false;          // light, half, view of one term: asked for most, and written out
  std::size_t map_values_ = 0;  // of one term
  std::array<const std::uint8_t*, max_factors> bytes_{};
  std::array<const float*, max_factors> floats_{};
  std::vector<Texel> texels_;
};

}  // namespace weft::factor_maps
