#include "codecs/factor_maps/decode.h"

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "btf/raw_appearance.h"
#include "codecs/factor_maps/half_difference.h"

namespace weft::factor_maps {

namespace {

using Byte16 = std::uint8_t __attribute__((vector_size(16)));
using Int8 = std::int32_t __attribute__((vector_size(32)));

alignas(64) constexpr std::array<float, 16> left_weight{1, 1, 1, 0, 0, 0, 0, 0,
                                                        0, 0, 1, 1, 1, 0, 0, 0};
alignas(64) constexpr std::array<float, 16> right_minus_left{-1, -1, -1, 1,  1,  1, 0, 0,
                                                             0,  0,  -1, -1, -1, 1, 1, 1};
alignas(64) constexpr std::array<float, 16> upper_weight{1, 1, 1, 1, 1, 1, 1, 1,
                                                         0, 0, 0, 0, 0, 0, 0, 0};
alignas(64) constexpr std::array<float, 16> lower_minus_upper{-1, -1, -1, -1, -1, -1, -1, -1,
                                                              1,  1,  1,  1,  1,  1,  1,  1};

// The compiler's own conversion of vectors takes bytes apart in many steps: half of the decoder's
// time.
inline Vec16 floats_of(const Byte16& bytes) {
#ifdef __AVX512F__
  // Unmasked, GCC 12 takes its own header for uninitialised (its bug 105593).
  using Int16 = std::int32_t __attribute__((vector_size(64)));
  return __builtin_convertvector((Int16)_mm512_maskz_cvtepu8_epi32(0xFFFF, (__m128i)bytes), Vec16);
#elif defined(__AVX2__)
  const auto b = (__m128i)bytes;
  return {(Vec8)_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(b)),
          (Vec8)_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_unpackhi_epi64(b, b)))};
#else
  using Byte8 = std::uint8_t __attribute__((vector_size(8)));
  std::array<Byte8, 2> halves;
  std::memcpy(&halves, &bytes, sizeof halves);
  const auto wide = [](const Byte8& half) {
    return __builtin_convertvector(__builtin_convertvector(half, Int8), Vec8);
  };
  return {wide(halves[0]), wide(halves[1])};
#endif
}

// Eight values from `row` on, of which six count, and eight that end with the six of the row below:
// that way neither reads beyond the map.
inline Vec16 two_rows(const std::uint8_t* row, std::size_t row_values) {
  std::array<std::uint64_t, 2> rows;
  std::memcpy(&rows[0], row, 8);
  std::memcpy(&rows[1], row + row_values - 2, 8);
  Byte16 bytes;
  std::memcpy(&bytes, &rows, sizeof bytes);
  return floats_of(bytes);
}
inline Vec16 two_rows(const float* row, std::size_t row_values) {
  return joined(load<Vec8>(row), load<Vec8>(row + row_values - 2));
}

inline Vec4 low(const Vec8& v) {
  Vec4 result;
  std::memcpy(&result, &v, sizeof result);
  return result;
}

// r g b: of each the two in the upper row, from 0 on, and the two in the lower row, from 10 on.
inline Vec4 folded(const Vec16& v) {
#ifdef __AVX512F__
  using Int16 = std::int32_t __attribute__((vector_size(64)));
  const Vec8 rows = low_half(
      v + __builtin_shuffle(v, Int16{10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
#else
  const Vec8 rows = v.low + __builtin_shuffle(v.high, Int8{2, 3, 4, 5, 6, 7, 0, 1});
#endif
  return low(rows + __builtin_shuffle(rows, Int8{3, 4, 5, 6, 7, 0, 1, 2}));
}

template <typename Value>
[[gnu::always_inline]] inline Vec4 blended(const Value* first, std::size_t row_values,
                                           const Vec16& weight) {
  return folded(two_rows(first, row_values) * weight);
}

template <typename Value>
inline Vec4 looked_up(const Value* map, std::size_t row_values, const MapPlace& place) {
  return blended(map + place.first, row_values, place.weight);
}

inline Vec16 blend_weights(float across, float down) {
  return (load<Vec16>(left_weight.data()) + across * load<Vec16>(right_minus_left.data())) *
         (load<Vec16>(upper_weight.data()) + down * load<Vec16>(lower_minus_upper.data()));
}

inline MapPlace map_place(int first, float across, float down) {
  return {static_cast<std::uint32_t>(first), blend_weights(across, down)};
}

// p in the parabolic plane, `last` = resolution - 1. A NaN may not be cast; it stays in the
// weights.
inline MapPlace place_at(float px, float py, int resolution) {
  const auto last = static_cast<float>(resolution - 1);
  const float x = std::clamp((px + 1) * 0.5F * last, 0.0F, last);
  const float y = std::clamp((1 - py) * 0.5F * last, 0.0F, last);
  const int column = x > 0 ? std::min(static_cast<int>(x), resolution - 2) : 0;
  const int row = y > 0 ? std::min(static_cast<int>(y), resolution - 2) : 0;
  return map_place(3 * (row * resolution + column), x - static_cast<float>(column),
                   y - static_cast<float>(row));
}

// The parabolic image of the half-vector, without normalising it first.
inline MapPlace half_place(const Direction& light, const Direction& view, int resolution) {
  const Vec3 sum = light + view;
  const float scale = 1 / (std::sqrt(sum ^ sum) + sum.z);
  return place_at(sum.x * scale, sum.y * scale, resolution);
}

inline MapPlace place_of(const Direction& d, int resolution) {
  const float scale = 1 / (1 + d.z);
  return place_at(d.x * scale, d.y * scale, resolution);
}

struct Turn {
  float cosine;
  float sine;
};

Turn turn_back(int steps) {
  const double angle = -2 * std::numbers::pi * steps / rotation_steps;
  return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
}

Direction turned(const Direction& d, const Turn& turn) {
  return {turn.cosine * d.x - turn.sine * d.y, turn.sine * d.x + turn.cosine * d.y, d.z};
}

}  // namespace

Decoder::Decoder(const Model& model) : model_(model), map_values_(model.values_a_map()) {
  float unit = 1;
  for (std::size_t f = 0; f < model.factors.size(); ++f) {
    const Factor& factor = model.factors[f];
    single_terms_ = single_terms_ && factor.terms == 1;
    bytes_[f] = factor.maps.bytes.data();
    floats_[f] = factor.maps.floats.data();
    if (factor.maps.floats.empty()) unit /= 255.0F;
  }
  plain_ =
      single_terms_ && model.factors.size() == 3 && model.factors[1].projection == Projection::half;
  texels_.resize(model.texels());
  for (std::size_t t = 0; t < texels_.size(); ++t) {
    const Rgb scale = (model.scale.size() > 0 ? model.scale_of(t) : Rgb(1, 1, 1)) * unit;
    texels_[t].scale = Vec4{scale.x, scale.y, scale.z, 0};
    for (std::size_t f = 0; f < model.factors.size(); ++f) {
      texels_[t].map[f] = static_cast<std::uint32_t>(model.map_of(f, t));
    }
  }
}

template <typename Value>
[[gnu::always_inline]] inline Vec4 Decoder::product(const Value* const* maps, const Texel& texel,
                                                    const MapPlaces& places) const {
  const std::size_t row_values = 3 * static_cast<std::size_t>(model_.resolution);
  const auto own = [&](std::size_t f) {
    return looked_up(maps[f] + texel.map[f] * map_values_, row_values, places[f]);
  };
  if (plain_) return texel.scale * own(0) * own(1) * own(2);
  return product_of_links(maps, texel, places);
}

template <typename Value>
Vec4 Decoder::product_of_links(const Value* const* maps, const Texel& texel,
                               const MapPlaces& places) const {
  const std::size_t row_values = 3 * static_cast<std::size_t>(model_.resolution);
  Vec4 result = texel.scale;
  if (single_terms_) {
    for (std::size_t f = 0; f < model_.factors.size(); ++f)
      result *= looked_up(maps[f] + texel.map[f] * map_values_, row_values, places[f]);
    return result;
  }
  for (int link = 0; link < link_count; ++link) {
    Vec4 sum = {};
    bool present = false;
    for (int term = 0;; ++term) {
      Vec4 one = {1, 1, 1, 1};
      bool has_term = false;
      for (std::size_t f = 0; f < model_.factors.size(); ++f) {
        const Factor& factor = model_.factors[f];
        if (link_of(factor.projection) != link || term >= factor.terms) continue;
        const std::size_t map = static_cast<std::size_t>(texel.map[f]) * factor.terms + term;
        one *= looked_up(maps[f] + map * map_values_, row_values, places[f]);
        has_term = true;
      }
      if (!has_term) break;
      present = true;
      sum += one;
    }
    if (!present) continue;
    const Vec4 zero = {};
    result *= sum < zero ? zero : sum;
  }
  return result;
}

[[gnu::always_inline]] inline Vec4 Decoder::value4(std::size_t texel,
                                                   const MapPlaces& places) const {
  return bytes_[0] != nullptr ? product(bytes_.data(), texels_[texel], places)
                              : product(floats_.data(), texels_[texel], places);
}

Rgb Decoder::value(std::size_t texel, const MapPlaces& places) const {
  const Vec4 v = value4(texel, places);
  return {v[0], v[1], v[2]};
}

MapPlaces Decoder::places(const Direction& light_asked, const Direction& view_asked,
                          int rotation) const {
  Direction light = light_asked;
  Direction view = view_asked;
  if (rotation != 0) {
    const Turn turn = turn_back(rotation);
    light = turned(light, turn);
    view = turned(view, turn);
  }
  MapPlaces places;
  if (plain_) {
    places[0] = place_of(light, model_.resolution);
    places[1] = half_place(light, view, model_.resolution);
    places[2] = place_of(view, model_.resolution);
    return places;
  }
  for (std::size_t f = 0; f < model_.factors.size(); ++f) {
    switch (model_.factors[f].projection) {
      case Projection::light:
        places[f] = place_of(light, model_.resolution);
        break;
      case Projection::half:
        places[f] = half_place(light, view, model_.resolution);
        break;
      case Projection::difference:
        places[f] = place_of(difference_vector(light, view), model_.resolution);
        break;
      case Projection::view:
        places[f] = place_of(view, model_.resolution);
        break;
    }
  }
  return places;
}

Rgb Decoder::level_value(const Level& level, const Texcoord& uv, const Direction& light,
                         const Direction& view, const MapPlaces& places) const {
  const TexelStencil texels = bilinear_texels(uv, level.width, level.height);
  Vec4 sum = {};
  for (std::size_t t = 0; t < 4; ++t) {
    if (texels.weight[t] == 0) continue;
    const std::size_t texel = level.first + texels.index[t];
    const Vec4 value = model_.rotation.empty()
                           ? value4(texel, places)
                           : value4(texel, this->places(light, view, model_.rotation[texel]));
    sum += value * texels.weight[t];
  }
  return Rgb(sum[0], sum[1], sum[2]) * light.z;
}

Rgb Decoder::evaluate(const Texcoord& uv, const Direction& light, const Direction& view,
                      float lod) const {
  if (!(light.z > 0) || !(view.z > 0)) return {0, 0, 0};
  const MapPlaces shared = places(light, view, 0);
  const auto last = static_cast<float>(model_.levels.size() - 1);
  const float level = lod > 0 ? std::min(lod, last) : 0;  // a NaN is level 0
  const auto fine = static_cast<std::size_t>(level);
  const float blend = level - static_cast<float>(fine);
  const Rgb value = level_value(model_.levels[fine], uv, light, view, shared);
  if (!(blend > 0)) return value;
  const Rgb coarse = level_value(model_.levels[fine + 1], uv, light, view, shared);
  return value * (1 - blend) + coarse * blend;
}

namespace {

// A NaN (the half of opposite directions on the horizon) lies at 0: of std::max, the first stays.
PlaceLanes place_lanes(const Batch<float>& px, const Batch<float>& py, int resolution) {
  const auto last = static_cast<float>(resolution - 1);
  PlaceLanes places;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const float x = std::min(std::max(0.0F, (px[i] + 1) * 0.5F * last), last);
    const float y = std::min(std::max(0.0F, (1 - py[i]) * 0.5F * last), last);
    const int column = std::min(static_cast<int>(x), resolution - 2);
    const int row = std::min(static_cast<int>(y), resolution - 2);
    places.first[i] = 3 * (row * resolution + column);
    places.across[i] = x - static_cast<float>(column);
    places.down[i] = y - static_cast<float>(row);
  }
  return places;
}

// Of directions.
PlaceLanes place_lanes(const DirectionLanes& d, int resolution) {
  alignas(64) Batch<float> px;
  alignas(64) Batch<float> py;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const float scale = 1 / (1 + d.z[i]);
    px[i] = d.x[i] * scale;
    py[i] = d.y[i] * scale;
  }
  return place_lanes(px, py, resolution);
}

// Of the half-vectors of pairs of them.
PlaceLanes half_lanes(const DirectionLanes& light, const DirectionLanes& view, int resolution) {
  alignas(64) Batch<float> px;
  alignas(64) Batch<float> py;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const float x = light.x[i] + view.x[i];
    const float y = light.y[i] + view.y[i];
    const float z = light.z[i] + view.z[i];
    const float scale = 1 / (std::sqrt(x * x + y * y + z * z) + z);
    px[i] = x * scale;
    py[i] = y * scale;
  }
  return place_lanes(px, py, resolution);
}

}  // namespace

void Decoder::evaluate(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const {
  // What turns directions goes one by one.
  if (!model_.rotation.empty()) {
    for (std::size_t i = 0; i < queries.size(); ++i)
      answers[i] = evaluate(queries[i].uv, queries[i].light, queries[i].view, queries[i].lod);
    return;
  }
  decode_in_batches(queries, answers, [this](const QueryBatch& batch) { return decode(batch); });
}

std::array<PlaceLanes, max_factors> Decoder::places(const QueryBatch& batch) const {
  std::array<PlaceLanes, max_factors> places;
  for (std::size_t f = 0; f < model_.factors.size(); ++f) {
    switch (model_.factors[f].projection) {
      case Projection::light:
        places[f] = place_lanes(batch.light, model_.resolution);
        break;
      case Projection::half:
        places[f] = half_lanes(batch.light, batch.view, model_.resolution);
        break;
      case Projection::difference: {
        DirectionLanes difference;
        for (std::size_t i = 0; i < batch_lanes; ++i) {
          const Direction d =
              difference_vector({batch.light.x[i], batch.light.y[i], batch.light.z[i]},
                                {batch.view.x[i], batch.view.y[i], batch.view.z[i]});
          difference.x[i] = d.x;
          difference.y[i] = d.y;
          difference.z[i] = d.z;
        }
        places[f] = place_lanes(difference, model_.resolution);
        break;
      }
      case Projection::view:
        places[f] = place_lanes(batch.view, model_.resolution);
        break;
    }
  }
  return places;
}

// The four texels around uv at each lane's level, weights times `share`.
TexelBatch Decoder::level_texels(const QueryBatch& batch, const Batch<std::int32_t>& levels,
                                 const Batch<float>& share) const {
  Batch<std::int32_t> width;
  Batch<std::int32_t> height;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    width[i] = model_.levels[levels[i]].width;
    height[i] = model_.levels[levels[i]].height;
  }
  TexelBatch texels = texel_batch(column_batch(batch.u, width), row_batch(batch.v, height), width);
  for (std::size_t t = 0; t < 4; ++t) {
    for (std::size_t i = 0; i < batch_lanes; ++i) {
      texels.index[t][i] += static_cast<std::int32_t>(model_.levels[levels[i]].first);
      texels.weight[t][i] *= share[i];
    }
  }
  return texels;
}

Batch<Rgb> Decoder::decode(const QueryBatch& batch) const {
  const LevelBatch level = level_batch(batch.lod, model_.levels.size());
  alignas(64) Batch<float> rest;
  for (std::size_t i = 0; i < batch_lanes; ++i) rest[i] = 1 - level.blend[i];
  const std::array<PlaceLanes, max_factors> places = this->places(batch);
  Batch<Vec4> sums{};
  add_level(level_texels(batch, level.fine, rest), places, sums);
  if (std::ranges::max(level.blend) > 0)
    add_level(level_texels(batch, level.coarse, level.blend), places, sums);
  Batch<Rgb> values;
  for (std::size_t i = 0; i < batch_lanes; ++i)
    values[i] = Rgb(sums[i][0], sums[i][1], sums[i][2]) * batch.light.z[i];
  return values;
}

void Decoder::add_level(const TexelBatch& texels, const std::array<PlaceLanes, max_factors>& places,
                        Batch<Vec4>& sums) const {
  if (plain_) {
    return bytes_[0] != nullptr ? add_plain(bytes_.data(), texels, places, sums)
                                : add_plain(floats_.data(), texels, places, sums);
  }
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    MapPlaces of_lane;
    for (std::size_t f = 0; f < model_.factors.size(); ++f)
      of_lane[f] = map_place(places[f].first[i], places[f].across[i], places[f].down[i]);
    for (std::size_t t = 0; t < 4; ++t)
      sums[i] += value4(texels.index[t][i], of_lane) * texels.weight[t][i];
  }
}

template <typename Value>
void Decoder::add_plain(const Value* const* maps, const TexelBatch& texels,
                        const std::array<PlaceLanes, max_factors>& places,
                        Batch<Vec4>& sums) const {
  const std::size_t row_values = 3 * static_cast<std::size_t>(model_.resolution);
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    std::array<Vec16, 3> weight;
    for (std::size_t f = 0; f < 3; ++f)
      weight[f] = blend_weights(places[f].across[i], places[f].down[i]);
    Vec4 sum = sums[i];
    for (std::size_t t = 0; t < 4; ++t) {
      const Texel& texel = texels_[texels.index[t][i]];
      Vec4 product = texel.scale * texels.weight[t][i];
      for (std::size_t f = 0; f < 3; ++f) {
        product *= blended(maps[f] + texel.map[f] * map_values_ + places[f].first[i], row_values,
                           weight[f]);
      }
      sum += product;
    }
    sums[i] = sum;
  }
}

}  // namespace weft::factor_maps
