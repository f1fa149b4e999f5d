#include "codecs/factor_maps/decode.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "btf/raw_appearance.h"
#include "codecs/factor_maps/half_difference.h"
#include "codecs/factor_maps/map_lookup.h"

namespace weft::factor_maps {

namespace {

// Which of `plane_images` a factor asks for.
std::size_t image_of(Projection projection) {
  switch (projection) {
    case Projection::light:
      return 0;
    case Projection::half:
      return 1;
    case Projection::view:
      return 2;
    default:
      return 3;
  }
}

Direction turned(const Direction& d, const Turn& turn) {
  return {turn.cosine * d.x - turn.sine * d.y, turn.sine * d.x + turn.cosine * d.y, d.z};
}

PlaneLanes direction_images(const DirectionLanes& d) {
  PlaneLanes images;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const float scale = 1 / (1 + d.z[i]);
    images.x[i] = d.x[i] * scale;
    images.y[i] = d.y[i] * scale;
  }
  return images;
}

PlaneLanes half_images(const DirectionLanes& light, const DirectionLanes& view) {
  PlaneLanes images;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const float x = light.x[i] + view.x[i];
    const float y = light.y[i] + view.y[i];
    const float z = light.z[i] + view.z[i];
    const float scale = 1 / (std::sqrt(x * x + y * y + z * z) + z);
    images.x[i] = x * scale;
    images.y[i] = y * scale;
  }
  return images;
}

PlaneLanes difference_images(const DirectionLanes& light, const DirectionLanes& view) {
  DirectionLanes difference;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const Direction d =
        difference_vector({light.x[i], light.y[i], light.z[i]}, {view.x[i], view.y[i], view.z[i]});
    difference.x[i] = d.x;
    difference.y[i] = d.y;
    difference.z[i] = d.z;
  }
  return direction_images(difference);
}

}  // namespace

Decoder::Decoder(const Model& model)
    : model_(model),
      map_values_(model.values_a_map()),
      row_values_(3 * static_cast<std::size_t>(model.resolution)),
      texels_(model.texels()) {
  float unit = 1;
  for (std::size_t f = 0; f < model.factors.size(); ++f) {
    const Factor& factor = model.factors[f];
    single_terms_ = single_terms_ && factor.terms == 1;
    bytes_[f] = factor.maps.bytes.data();
    floats_[f] = factor.maps.floats.data();
    if (factor.maps.floats.empty()) unit /= 255.0F;
    has_difference_ = has_difference_ || factor.projection == Projection::difference;
  }
  plain_ =
      single_terms_ && model.factors.size() == 3 && model.factors[1].projection == Projection::half;
  for (int step = 0; step < rotation_steps; ++step) {
    const double angle = -2 * std::numbers::pi * step / rotation_steps;
    turn_back_cosine_[step] = static_cast<float>(std::cos(angle));
    turn_back_sine_[step] = static_cast<float>(std::sin(angle));
  }
  for (const std::uint8_t steps : model.rotation) turns_.push_back(turn_back(steps));
  for (std::size_t t = 0; t < texels_.size(); ++t) {
    const Rgb scale = (model.scale.size() > 0 ? model.scale_of(t) : Rgb(1, 1, 1)) * unit;
    const float steps = model.rotation.empty() ? 0 : model.rotation[t];
    texels_[t].scale_and_steps = Vec4{scale.x, scale.y, scale.z, steps};
    for (std::size_t f = 0; f < model.factors.size(); ++f) {
      texels_[t].map[f] = static_cast<std::uint32_t>(model.map_of(f, t) * model.factors[f].terms);
    }
  }
  if (!plain_ || !model.clustered || bytes_[0] == nullptr) return;
  for (std::size_t f = 0; f < pairs_.size(); ++f)
    pairs_[f] = texel_pairs(model.factors[f].maps.bytes, model.resolution);
}

template <typename Value>
Vec4 Decoder::product(const Value* const* maps, const Texel& texel, const MapPlaces& places) const {
  Vec4 result = texel.scale_and_steps;
  if (single_terms_) {
    for (std::size_t f = 0; f < model_.factors.size(); ++f)
      result *= looked_up(maps[f] + texel.map[f] * map_values_, row_values_, places[f]);
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
        one *= looked_up(maps[f] + (texel.map[f] + term) * map_values_, row_values_, places[f]);
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

Vec4 Decoder::texel_value(std::size_t texel, const MapPlaces& places) const {
  return bytes_[0] != nullptr ? product(bytes_.data(), texels_[texel], places)
                              : product(floats_.data(), texels_[texel], places);
}

Rgb Decoder::value(std::size_t texel, const MapPlaces& places) const {
  const Vec4 v = texel_value(texel, places);
  return {v[0], v[1], v[2]};
}

/// Of four texels.
/// @param texels   (t) to the texel and its weight.
/// @param look_up  (map, factor, t) to the factor's value there.
template <typename Texels, typename LookUp>
[[gnu::always_inline]] inline Vec4 Decoder::plain_sum(const Texels& texels,
                                                      const LookUp& look_up) const {
  const auto sum_in = [&](const auto& maps, std::size_t stride) {
    Vec4 sum{};
    for (std::size_t t = 0; t < 4; ++t) {
      const auto [index, weight] = texels(t);
      const Texel& texel = texels_[index];
      Vec4 product = texel.scale_and_steps * weight;
      for (std::size_t f = 0; f < 3; ++f) product *= look_up(&maps[f][texel.map[f] * stride], f, t);
      sum += product;
    }
    return sum;
  };
  if (!pairs_[0].empty()) return sum_in(pairs_, pairs_a_map(model_.resolution));
  return bytes_[0] != nullptr ? sum_in(bytes_, map_values_) : sum_in(floats_, map_values_);
}

MapPlaces Decoder::places(const Direction& light_asked, const Direction& view_asked,
                          int rotation) const {
  const Direction light = turned(light_asked, turn_back(rotation));
  const Direction view = turned(view_asked, turn_back(rotation));
  const PlaneQuad images = has_difference_
                               ? plane_images(light, view, difference_vector(light, view))
                               : plane_images(light, view);
  const std::array<MapPlace, 4> all = map_places(images, model_.resolution);
  MapPlaces places;
  for (std::size_t f = 0; f < model_.factors.size(); ++f)
    places[f] = all[image_of(model_.factors[f].projection)];
  return places;
}

Vec4 Decoder::level_value(const Level& level, const Texcoord& uv, const MapPlaces& places) const {
  const TexelStencil stencil = bilinear_texels(uv, level.width, level.height);
  if (!plain_) {
    Vec4 sum{};
    for (std::size_t t = 0; t < 4; ++t)
      sum += texel_value(level.first + stencil.index[t], places) * stencil.weight[t];
    return sum;
  }
  return plain_sum(
      [&](std::size_t t) { return std::pair(level.first + stencil.index[t], stencil.weight[t]); },
      [&](const auto* map, std::size_t f, std::size_t) {
        return looked_up(map, row_values_, places[f]);
      });
}

Vec4 Decoder::turned_level_value(const Level& level, const Texcoord& uv, const Direction& light,
                                 const Direction& view) const {
  const TexelStencil stencil = bilinear_texels(uv, level.width, level.height);
  if (!plain_) {
    Vec4 sum{};
    for (std::size_t t = 0; t < 4; ++t) {
      const std::size_t texel = level.first + stencil.index[t];
      sum += texel_value(texel, places(light, view, model_.rotation[texel])) * stencil.weight[t];
    }
    return sum;
  }
  // Turning a direction about the normal turns its image, and half-vectors turn with their pair.
  Vec4 cosine;
  Vec4 sine;
  for (std::size_t t = 0; t < 4; ++t) {
    const Turn& turn = turns_[level.first + stencil.index[t]];
    cosine[t] = turn.cosine;
    sine[t] = turn.sine;
  }
  const PlaneQuad images = plane_images(light, view);
  std::array<std::array<MapPlace, 4>, 3> places;
  for (std::size_t f = 0; f < 3; ++f) {
    const PlaneQuad turned{cosine * images.x[f] - sine * images.y[f],
                           sine * images.x[f] + cosine * images.y[f]};
    places[f] = map_places(turned, model_.resolution);
  }
  return plain_sum(
      [&](std::size_t t) { return std::pair(level.first + stencil.index[t], stencil.weight[t]); },
      [&](const auto* map, std::size_t f, std::size_t t) {
        return looked_up(map, row_values_, places[f][t]);
      });
}

Rgb Decoder::evaluate(const Texcoord& uv, const Direction& light, const Direction& view,
                      float lod) const {
  if (!(light.z > 0) || !(view.z > 0)) return {0, 0, 0};
  const auto last = static_cast<float>(model_.levels.size() - 1);
  const float level = lod > 0 ? std::min(lod, last) : 0;  // a NaN is level 0
  const auto fine = static_cast<std::size_t>(level);
  const float blend = level - static_cast<float>(fine);
  const auto blended = [&](const auto& value_of) {
    const Vec4 value = value_of(model_.levels[fine]);
    if (!(blend > 0)) return value;
    return value * (1 - blend) + value_of(model_.levels[fine + 1]) * blend;
  };
  Vec4 value;
  if (model_.rotation.empty()) {
    const MapPlaces shared = places(light, view, 0);
    value = blended([&](const Level& of) { return level_value(of, uv, shared); });
  } else {
    value = blended([&](const Level& of) { return turned_level_value(of, uv, light, view); });
  }
  return Rgb(value[0], value[1], value[2]) * light.z;
}

void Decoder::evaluate(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const {
  // Several terms, or a difference, of turned texels are seldom asked for: one by one.
  if (!model_.rotation.empty() && !plain_) {
    for (std::size_t i = 0; i < queries.size(); ++i)
      answers[i] = evaluate(queries[i].uv, queries[i].light, queries[i].view, queries[i].lod);
    return;
  }
#ifdef __AVX512F__
  if (!pairs_[0].empty()) {
    decode_in_batches(queries, answers,
                      [this](const QueryBatch& batch) { return decode_pairs(batch); });
    return;
  }
#endif
  decode_in_batches(queries, answers, [this](const QueryBatch& batch) { return decode(batch); });
}

std::array<PlaneLanes, max_factors> Decoder::images(const QueryBatch& batch) const {
  std::array<PlaneLanes, max_factors> images;
  for (std::size_t f = 0; f < model_.factors.size(); ++f) {
    switch (model_.factors[f].projection) {
      case Projection::light:
        images[f] = direction_images(batch.light);
        break;
      case Projection::half:
        images[f] = half_images(batch.light, batch.view);
        break;
      case Projection::difference:
        images[f] = difference_images(batch.light, batch.view);
        break;
      case Projection::view:
        images[f] = direction_images(batch.view);
        break;
    }
  }
  return images;
}

// The four texels around uv at each lane's level, weights times `share`.
TexelBatch Decoder::level_texels(const QueryBatch& batch, const Batch<std::int32_t>& levels,
                                 const Batch<float>& share) const {
  TexelBatch texels = level_texel_batch(batch, levels, [&](std::int32_t l) {
    return std::pair(model_.levels[l].width, model_.levels[l].height);
  });
  alignas(64) Batch<std::int32_t> first;
  for (std::size_t i = 0; i < batch_lanes; ++i)
    first[i] = static_cast<std::int32_t>(model_.levels[levels[i]].first);
  for (std::size_t t = 0; t < 4; ++t) {
    for (std::size_t i = 0; i < batch_lanes; ++i) {
      texels.index[t][i] += first[i];
      texels.weight[t][i] *= share[i];
    }
  }
  return texels;
}

Batch<Rgb> Decoder::decode(const QueryBatch& batch) const {
  const LevelBatch level = level_batch(batch.lod, model_.levels.size());
  alignas(64) Batch<float> rest;
  for (std::size_t i = 0; i < batch_lanes; ++i) rest[i] = 1 - level.blend[i];
  const std::array<PlaneLanes, max_factors> images = this->images(batch);
  Batch<Vec4> sums{};
  const auto add = [&](const TexelBatch& texels) {
    return model_.rotation.empty() ? add_level(texels, images, sums)
                                   : add_turned_level(texels, images, sums);
  };
  add(level_texels(batch, level.fine, rest));
  if (std::ranges::max(level.blend) > 0) add(level_texels(batch, level.coarse, level.blend));
  Batch<Rgb> values;
  for (std::size_t i = 0; i < batch_lanes; ++i)
    values[i] = Rgb(sums[i][0], sums[i][1], sums[i][2]) * batch.light.z[i];
  return values;
}

void Decoder::add_level(const TexelBatch& texels, const std::array<PlaneLanes, max_factors>& images,
                        Batch<Vec4>& sums) const {
  std::array<PlaceLanes, max_factors> places;
  for (std::size_t f = 0; f < model_.factors.size(); ++f)
    places[f] = place_lanes(images[f], model_.resolution);
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    if (!plain_) {
      MapPlaces of_lane;
      for (std::size_t f = 0; f < model_.factors.size(); ++f) of_lane[f] = places[f].lane(i);
      for (std::size_t t = 0; t < 4; ++t)
        sums[i] += texel_value(texels.index[t][i], of_lane) * texels.weight[t][i];
      continue;
    }
    std::array<Vec16, 3> weight;
    for (std::size_t f = 0; f < 3; ++f)
      weight[f] = blend_weights(places[f].across[i], places[f].down[i]);
    sums[i] +=
        plain_sum([&](std::size_t t) { return std::pair(texels.index[t][i], texels.weight[t][i]); },
                  [&](const auto* map, std::size_t f, std::size_t) {
                    return looked_up(map, row_values_, places[f].lane(i), weight[f]);
                  });
  }
}

// Of plain ones. The first texels of all sixteen, then the
// second ones: what is found side by side is not asked for again at once, while it is still being
// stored.
void Decoder::add_turned_level(const TexelBatch& texels,
                               const std::array<PlaneLanes, max_factors>& images,
                               Batch<Vec4>& sums) const {
  std::array<std::array<PlaceLanes, 3>, 4> places;
  for (std::size_t t = 0; t < 4; ++t) {
    alignas(64) Batch<float> cosine;
    alignas(64) Batch<float> sine;
    for (std::size_t i = 0; i < batch_lanes; ++i) {
      const Turn& turn = turns_[texels.index[t][i]];
      cosine[i] = turn.cosine;
      sine[i] = turn.sine;
    }
    for (std::size_t f = 0; f < 3; ++f) {
      PlaneLanes turned;
      for (std::size_t i = 0; i < batch_lanes; ++i) {
        turned.x[i] = cosine[i] * images[f].x[i] - sine[i] * images[f].y[i];
        turned.y[i] = sine[i] * images[f].x[i] + cosine[i] * images[f].y[i];
      }
      places[t][f] = place_lanes(turned, model_.resolution);
    }
  }
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    sums[i] +=
        plain_sum([&](std::size_t t) { return std::pair(texels.index[t][i], texels.weight[t][i]); },
                  [&](const auto* map, std::size_t f, std::size_t t) {
                    return looked_up(map, row_values_, places[t][f].lane(i));
                  });
  }
}

}  // namespace weft::factor_maps
