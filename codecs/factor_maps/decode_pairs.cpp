// Sixteen queries of plain codebooks of bytes at once, from their directions to their values.
#include "codecs/factor_maps/decode.h"

#ifdef __AVX512F__

#include <algorithm>
#include <cstring>
#include <utility>

#include "codecs/transposed_lanes.h"

namespace weft::factor_maps {

namespace {

using UInt16 = std::uint32_t __attribute__((vector_size(64)));

// Entries of a table of 64.
inline Vec16 chosen(const std::array<float, rotation_steps>& table, const UInt16& number) {
  static_assert(rotation_steps == 4 * batch_lanes);
  const auto of_half = [&](std::size_t first) {
    return __builtin_shuffle(load<Vec16>(&table[first]), load<Vec16>(&table[first + 16]), number);
  };
  return number < 32 ? of_half(0) : of_half(32);
}

// Where the maps of a texel of each lane are to be looked up.
struct PairLanes {
  alignas(64) std::array<Batch<std::uint32_t>, 3> pair;
  std::array<Vec16, 3> across;
  std::array<Vec16, 3> down;
  RgbLanes scale;
};

}  // namespace

// First all places, then all lookups: what was written side by side would have to be waited for if
// it were read one by one right after.
void Decoder::add_level_of_pairs(const TexelBatch& texels,
                                 const std::array<PlaneLanes, max_factors>& images,
                                 RgbLanes& sums) const {
  const auto stride = static_cast<std::uint32_t>(pairs_a_map(model_.resolution));
  std::array<PairLanes, 4> lanes;
  for (std::size_t t = 0; t < 4; ++t) {
    const std::array<Vec16, 4> front =
        lanes_at([&](std::size_t i) { return &texels_[texels.index[t][i]].scale_and_steps; });
    const std::array<Vec16, 4> maps =
        lanes_at([&](std::size_t i) { return texels_[texels.index[t][i]].map.data(); });
    lanes[t].scale = RgbLanes{front[0], front[1], front[2]} * load<Vec16>(texels.weight[t].data());
    const UInt16 steps = __builtin_convertvector(front[3], UInt16);
    const Vec16 cosine = chosen(turn_back_cosine_, steps);
    const Vec16 sine = chosen(turn_back_sine_, steps);
    for (std::size_t f = 0; f < pairs_.size(); ++f) {
      const Vec16 x = load<Vec16>(images[f].x.data());
      const Vec16 y = load<Vec16>(images[f].y.data());
      PlaneLanes turned;
      const Vec16 tx = cosine * x - sine * y;
      const Vec16 ty = sine * x + cosine * y;
      std::memcpy(turned.x.data(), &tx, sizeof tx);
      std::memcpy(turned.y.data(), &ty, sizeof ty);
      const PlaceLanes places = place_lanes(turned, model_.resolution);
      UInt16 first;
      std::memcpy(&first, places.first.data(), sizeof first);
      first += (UInt16)maps[f] * stride;
      std::memcpy(lanes[t].pair[f].data(), &first, sizeof first);
      lanes[t].across[f] = load<Vec16>(places.across.data());
      lanes[t].down[f] = load<Vec16>(places.down.data());
    }
  }
  for (const PairLanes& of : lanes) {
    RgbLanes product = of.scale;
    for (std::size_t f = 0; f < pairs_.size(); ++f)
      product *= looked_up(pairs_[f].data(), of.pair[f], of.across[f], of.down[f]);
    sums += product;
  }
}

Batch<Rgb> Decoder::decode_pairs(const QueryBatch& batch) const {
  const LevelBatch level = level_batch(batch.lod, model_.levels.size());
  alignas(64) Batch<float> rest;
  for (std::size_t i = 0; i < batch_lanes; ++i) rest[i] = 1 - level.blend[i];
  const std::array<PlaneLanes, max_factors> images = this->images(batch);
  RgbLanes sums{};
  add_level_of_pairs(level_texels(batch, level.fine, rest), images, sums);
  if (std::ranges::max(level.blend) > 0)
    add_level_of_pairs(level_texels(batch, level.coarse, level.blend), images, sums);
  sums = sums * load<Vec16>(batch.light.z.data());
  Batch<Rgb> values;
  for (std::size_t i = 0; i < batch_lanes; ++i) values[i] = {sums.r[i], sums.g[i], sums.b[i]};
  return values;
}

}  // namespace weft::factor_maps

#endif
