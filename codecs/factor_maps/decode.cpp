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

using Byte8 = std::uint8_t __attribute__((vector_size(8)));
using Int8 = std::int32_t __attribute__((vector_size(32)));

constexpr Float8 left_weight = {1, 1, 1, 0, 0, 0, 0, 0};
constexpr Float8 right_minus_left = {-1, -1, -1, 1, 1, 1, 0, 0};

// The compiler's own conversion of vectors takes bytes apart in many steps: half of the decoder's
// time.
inline Float8 floats_of(std::uint64_t eight_bytes) {
#ifdef __AVX2__
  return _mm256_cvtepi32_ps(
      _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<std::int64_t>(eight_bytes))));
#else
  Byte8 bytes;
  std::memcpy(&bytes, &eight_bytes, sizeof bytes);
  return __builtin_convertvector(__builtin_convertvector(bytes, Int8), Float8);
#endif
}

// Eight values from `row` on, of which six count: there is a row below, so none is beyond the end.
inline Float8 upper_row(const std::uint8_t* row) {
  std::uint64_t bytes;
  std::memcpy(&bytes, row, sizeof bytes);
  return floats_of(bytes);
}
inline Float8 upper_row(const float* row) {
  Float8 values;
  std::memcpy(&values, row, sizeof values);
  return values;
}

// The same of a row that may be a map's last: read from two values before, which are there.
inline Float8 lower_row(const std::uint8_t* row) {
  std::uint64_t bytes;
  std::memcpy(&bytes, row - 2, sizeof bytes);
  return floats_of(bytes >> 16);
}
inline Float8 lower_row(const float* row) {
  Float8 values;
  std::memcpy(&values, row - 2, sizeof values);
  return __builtin_shuffle(values, Int8{2, 3, 4, 5, 6, 7, 0, 1});
}

inline Float4 low(const Float8& v) {
  Float4 result;
  std::memcpy(&result, &v, sizeof result);
  return result;
}

template <typename Value>
inline Float4 looked_up(const Value* map, std::size_t row_values, const MapPlace& place) {
  const Value* upper = map + place.first;
  const Float8 sum = upper_row(upper) * place.upper + lower_row(upper + row_values) * place.lower;
  return low(sum + __builtin_shuffle(sum, Int8{3, 4, 5, 3, 4, 5, 3, 3}));
}

// p in the parabolic plane, `last` = resolution - 1. A NaN may not be cast; it stays in the
// weights.
inline MapPlace place_at(float px, float py, int resolution) {
  const auto last = static_cast<float>(resolution - 1);
  const float x = std::clamp((px + 1) * 0.5F * last, 0.0F, last);
  const float y = std::clamp((1 - py) * 0.5F * last, 0.0F, last);
  const int column = x > 0 ? std::min(static_cast<int>(x), resolution - 2) : 0;
  const int row = y > 0 ? std::min(static_cast<int>(y), resolution - 2) : 0;
  const float b = y - static_cast<float>(row);
  const Float8 across = left_weight + (x - static_cast<float>(column)) * right_minus_left;
  return {static_cast<std::uint32_t>(3 * (row * resolution + column)), across * (1 - b),
          across * b};
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
    texels_[t].scale = Float4{scale.x, scale.y, scale.z, 0};
    for (std::size_t f = 0; f < model.factors.size(); ++f) {
      texels_[t].map[f] = static_cast<std::uint32_t>(model.map_of(f, t));
    }
  }
}

template <typename Value>
inline Float4 Decoder::product(const Value* const* maps, const Texel& texel,
                               const MapPlaces& places) const {
  const std::size_t row_values = 3 * static_cast<std::size_t>(model_.resolution);
  const auto own = [&](std::size_t f) {
    return looked_up(maps[f] + texel.map[f] * map_values_, row_values, places[f]);
  };
  if (plain_) return texel.scale * own(0) * own(1) * own(2);
  Float4 result = texel.scale;
  if (single_terms_) {
    for (std::size_t f = 0; f < model_.factors.size(); ++f) result *= own(f);
    return result;
  }
  for (int link = 0; link < link_count; ++link) {
    Float4 sum = {};
    bool present = false;
    for (int term = 0;; ++term) {
      Float4 one = {1, 1, 1, 1};
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
    const Float4 zero = {};
    result *= sum < zero ? zero : sum;
  }
  return result;
}

inline Float4 Decoder::value4(std::size_t texel, const MapPlaces& places) const {
  return bytes_[0] != nullptr ? product(bytes_.data(), texels_[texel], places)
                              : product(floats_.data(), texels_[texel], places);
}

Rgb Decoder::value(std::size_t texel, const MapPlaces& places) const {
  const Float4 v = value4(texel, places);
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
  Float4 sum = {};
  for (std::size_t t = 0; t < 4; ++t) {
    if (texels.weight[t] == 0) continue;
    const std::size_t texel = level.first + texels.index[t];
    const Float4 value = model_.rotation.empty()
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

// Sixteen queries side by side: loops over these arrays become vector instructions.
constexpr std::size_t block_size = 16;
template <typename Value>
using Block = std::array<Value, block_size>;

struct DirectionBlock {
  Block<float> x, y, z;
};

// Where sixteen directions lie in a map, as `MapPlace` before its weights are spread.
struct PlaceBlock {
  Block<std::int32_t> first;
  Block<float> across, down;
};

// A NaN (the half of opposite directions on the horizon) lies at 0: of std::max, the first stays.
void place_block(const Block<float>& px, const Block<float>& py, int resolution,
                 PlaceBlock& places) {
  const auto last = static_cast<float>(resolution - 1);
  for (std::size_t i = 0; i < block_size; ++i) {
    const float x = std::min(std::max(0.0F, (px[i] + 1) * 0.5F * last), last);
    const float y = std::min(std::max(0.0F, (1 - py[i]) * 0.5F * last), last);
    const int column = std::min(static_cast<int>(x), resolution - 2);
    const int row = std::min(static_cast<int>(y), resolution - 2);
    places.first[i] = 3 * (row * resolution + column);
    places.across[i] = x - static_cast<float>(column);
    places.down[i] = y - static_cast<float>(row);
  }
}

// Parabolic images of directions, or of the half-vectors of pairs of them.
void place_block(const DirectionBlock& d, int resolution, PlaceBlock& places) {
  Block<float> px;
  Block<float> py;
  for (std::size_t i = 0; i < block_size; ++i) {
    const float scale = 1 / (1 + d.z[i]);
    px[i] = d.x[i] * scale;
    py[i] = d.y[i] * scale;
  }
  place_block(px, py, resolution, places);
}

void place_halves(const DirectionBlock& light, const DirectionBlock& view, int resolution,
                  PlaceBlock& places) {
  Block<float> px;
  Block<float> py;
  for (std::size_t i = 0; i < block_size; ++i) {
    const float x = light.x[i] + view.x[i];
    const float y = light.y[i] + view.y[i];
    const float z = light.z[i] + view.z[i];
    const float scale = 1 / (std::sqrt(x * x + y * y + z * z) + z);
    px[i] = x * scale;
    py[i] = y * scale;
  }
  place_block(px, py, resolution, places);
}

// The twin of `bilinear_texels`.
struct TexelBlock {
  std::array<Block<std::int32_t>, 4> index;
  std::array<Block<float>, 4> weight;
};

void texel_block(const Block<float>& u, const Block<float>& v, int width, int height,
                 TexelBlock& texels) {
  for (std::size_t i = 0; i < block_size; ++i) {
    const float x = (u[i] - std::floor(u[i])) * static_cast<float>(width) - 0.5F;
    const float y = (1 - (v[i] - std::floor(v[i]))) * static_cast<float>(height) - 0.5F;
    const float fx = std::floor(x);
    const float fy = std::floor(y);
    const int left = static_cast<int>(fx);
    const int top = static_cast<int>(fy);
    const int x0 = left < 0 ? width - 1 : left >= width ? 0 : left;
    const int x1 = left + 1 >= width ? 0 : left + 1;
    const int y0 = width * (top < 0 ? height - 1 : top >= height ? 0 : top);
    const int y1 = width * (top + 1 >= height ? 0 : top + 1);
    const float a = x - fx;
    const float b = y - fy;
    texels.index[0][i] = y0 + x0;
    texels.index[1][i] = y0 + x1;
    texels.index[2][i] = y1 + x0;
    texels.index[3][i] = y1 + x1;
    texels.weight[0][i] = (1 - a) * (1 - b);
    texels.weight[1][i] = a * (1 - b);
    texels.weight[2][i] = (1 - a) * b;
    texels.weight[3][i] = a * b;
  }
}

bool is_finite(const AppearanceQuery& q) {
  return std::isfinite(q.uv.x + q.uv.y + q.light.x + q.light.y + q.light.z + q.view.x + q.view.y +
                       q.view.z);
}

}  // namespace

void Decoder::evaluate(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const {
  for (std::size_t first = 0; first < queries.size(); first += block_size) {
    const std::size_t count = std::min(block_size, queries.size() - first);
    const auto part = queries.subspan(first, count);
    // What turns directions, asks a coarser level or is no number goes one by one.
    const bool alike = count == block_size && model_.rotation.empty() &&
                       std::ranges::all_of(part, [](const AppearanceQuery& q) {
                         return !(q.lod > 0) && is_finite(q);
                       });
    if (alike) {
      evaluate_block(part, answers.subspan(first, count));
      continue;
    }
    for (std::size_t i = first; i < first + count; ++i) {
      const AppearanceQuery& q = queries[i];
      answers[i] = evaluate(q.uv, q.light, q.view, q.lod);
    }
  }
}

void Decoder::evaluate_block(std::span<const AppearanceQuery> queries,
                             std::span<Rgb> answers) const {
  Block<float> u;
  Block<float> v;
  DirectionBlock light;
  DirectionBlock view;
  for (std::size_t i = 0; i < block_size; ++i) {
    const AppearanceQuery& q = queries[i];
    u[i] = q.uv.x;
    v[i] = q.uv.y;
    // Below the horizon the answer is 0 whatever is read: read at the horizon.
    light.x[i] = q.light.x;
    light.y[i] = q.light.y;
    light.z[i] = std::max(q.light.z, 0.0F);
    view.x[i] = q.view.x;
    view.y[i] = q.view.y;
    view.z[i] = std::max(q.view.z, 0.0F);
  }
  TexelBlock texels;
  texel_block(u, v, model_.width(), model_.height(), texels);
  std::array<PlaceBlock, max_factors> blocks;
  for (std::size_t f = 0; f < model_.factors.size(); ++f) {
    switch (model_.factors[f].projection) {
      case Projection::light:
        place_block(light, model_.resolution, blocks[f]);
        break;
      case Projection::half:
        place_halves(light, view, model_.resolution, blocks[f]);
        break;
      case Projection::difference: {
        DirectionBlock difference;
        for (std::size_t i = 0; i < block_size; ++i) {
          const Direction d = difference_vector(queries[i].light, queries[i].view);
          difference.x[i] = d.x;
          difference.y[i] = d.y;
          difference.z[i] = d.z;
        }
        place_block(difference, model_.resolution, blocks[f]);
        break;
      }
      case Projection::view:
        place_block(view, model_.resolution, blocks[f]);
        break;
    }
  }
  for (std::size_t i = 0; i < block_size; ++i) {
    MapPlaces places;
    for (std::size_t f = 0; f < model_.factors.size(); ++f) {
      const Float8 across = left_weight + blocks[f].across[i] * right_minus_left;
      places[f] = {static_cast<std::uint32_t>(blocks[f].first[i]), across * (1 - blocks[f].down[i]),
                   across * blocks[f].down[i]};
    }
    Float4 sum = {};
    for (std::size_t t = 0; t < 4; ++t) {
      sum += value4(static_cast<std::size_t>(texels.index[t][i]), places) * texels.weight[t][i];
    }
    const bool above = queries[i].light.z > 0 && queries[i].view.z > 0;
    answers[i] = above ? Rgb(sum[0], sum[1], sum[2]) * queries[i].light.z : Rgb(0, 0, 0);
  }
}

}  // namespace weft::factor_maps
