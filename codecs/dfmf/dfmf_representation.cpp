#include "codecs/dfmf/dfmf_representation.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "btf/raw_appearance.h"
#include "codecs/branchless_exp.h"
#include "codecs/dfmf/colour.h"
#include "codecs/wide_vector.h"

namespace weft::dfmf {

namespace {

constexpr std::size_t most_quads = 3 * 256 / 4;

// Four texels' sums, weighted.
inline float blended(const Vec16& v, const std::array<float, 4>& weight) {
  std::array<Vec4, 4> quads;
  std::memcpy(&quads, &v, sizeof quads);
  return sum_of((quads[0] * weight[0] + quads[2] * weight[2]) +
                (quads[1] * weight[1] + quads[3] * weight[3]));
}

}  // namespace

DfmfRepresentation::DfmfRepresentation(Model model)
    : model_(std::move(model)),
      view_locator_(model_.head.views),
      light_locator_(model_.head.lights),
      ones_(model_.head.lights.size(), 1.0F),
      basis_(model_.basis.begin(), model_.basis.end()) {
  for (std::size_t i = 0; i < basis_.size(); ++i) basis_[i] *= model_.scale[i % model_.slots()];
}

Rgb DfmfRepresentation::decode(const TexelStencil& texels, const PairLane& neighbours) const {
  const std::size_t slots = model_.slots();
  std::array<Vec16, most_quads> weights;
  std::array<const float*, 4> rows;
  for (std::size_t t = 0; t < 4; ++t) rows[t] = &model_.weights[texels.index[t] * slots];
  for (std::size_t s = 0; s < slots; s += 4) {
    weights[s / 4] = joined(joined(load<Vec4>(rows[0] + s), load<Vec4>(rows[1] + s)),
                            joined(load<Vec4>(rows[2] + s), load<Vec4>(rows[3] + s)));
  }
  // a, b, c of each pair: [view][texel][light], the fourth light is none and weighs nothing
  std::array<std::array<Vec16, 3>, 3> channel;
  const std::array<std::size_t, 4> first_quad{0, model_.first_slot(1) / 4, model_.first_slot(2) / 4,
                                              slots / 4};
  for (std::size_t v = 0; v < 3; ++v) {
    std::array<const float*, 3> basis;
    for (std::size_t l = 0; l < 3; ++l) basis[l] = &basis_[neighbours.index[4 * v + l] * slots];
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<Vec16, 3> products{};
      for (std::size_t q = first_quad[c]; q < first_quad[c + 1]; ++q) {
        for (std::size_t l = 0; l < 3; ++l)
          products[l] += weights[q] * four_times(basis[l] + 4 * q);
      }
      channel[c][v] = pairwise_sums(pairwise_sums(products[0], products[1]),
                                    pairwise_sums(products[2], Vec16{}));
    }
  }
  const float epsilon = model_.epsilon;
  alignas(64) std::array<float, 48> a;
  alignas(64) std::array<float, 48> bright;  // Y + epsilon
  std::memcpy(&a, &channel[0], sizeof a);
  for (std::size_t i = 0; i < 48; ++i) bright[i] = epsilon * branchless_exp(a[i]);
  Vec16 red{};
  Vec16 green{};
  Vec16 blue{};
  for (std::size_t v = 0; v < 3; ++v) {
    const Vec16 e = load<Vec16>(&bright[16 * v]);
    const Vec16 weight = four_times(&neighbours.weight[4 * v]);
    const Vec16 y = e - epsilon;
    const Vec16 b = channel[1][v] * e;
    const Vec16 c = channel[2][v] * e;
    red += weight * not_negative(y + red_of_v * c);
    green += weight * not_negative(y - green_of_u * b - green_of_v * c);
    blue += weight * not_negative(y + blue_of_u * b);
  }
  return {blended(red, texels.weight), blended(green, texels.weight), blended(blue, texels.weight)};
}

// Rows lie wherever they do; those of the next query are asked for while this one is decoded.
void DfmfRepresentation::fetch(const TexelStencil& texels, const PairLane& neighbours) const {
  constexpr std::size_t floats_a_line = 16;
  const std::size_t slots = model_.slots();
  for (std::size_t s = 0; s < slots; s += floats_a_line) {
    for (const std::uint32_t texel : texels.index)
      __builtin_prefetch(&model_.weights[texel * slots + s]);
    for (std::size_t v = 0; v < 3; ++v) {
      for (std::size_t l = 0; l < 3; ++l)
        __builtin_prefetch(&basis_[neighbours.index[4 * v + l] * slots + s]);
    }
  }
}

Rgb DfmfRepresentation::evaluate(Texcoord uv, Direction light, Direction view,
                                 float /*lod*/) const {
  if (!(light.z > 0) || !(view.z > 0)) return {0, 0, 0};
  return decode(
      bilinear_texels(uv, model_.head.width, model_.head.height),
      pair_lane(model_.head.views.locate(view), model_.head.lights.locate(light), ones_, light.z));
}

void DfmfRepresentation::evaluate(std::span<const AppearanceQuery> queries,
                                  std::span<Rgb> answers) const {
  decode_in_batches(queries, answers, [this](const QueryBatch& batch) {
    const TexelBatch texels = texel_batch(batch, model_.head.width, model_.head.height);
    const Batch<PairLane> pairs =
        pair_batch(view_locator_.locate(model_.head.views, batch.view),
                   light_locator_.locate(model_.head.lights, batch.light), ones_, batch.light.z);
    Batch<Rgb> values;
    for (std::size_t i = 0; i < batch_lanes; ++i) {
      if (i + 1 < batch_lanes) fetch(texels.lane(i + 1), pairs[i + 1]);
      values[i] = decode(texels.lane(i), pairs[i]);
    }
    return values;
  });
}

std::size_t DfmfRepresentation::constant_bytes() const {
  return direction_table_bytes(model_.head) + (model_.scale.size() + 1) * sizeof(float);
}

void DfmfRepresentation::save(const std::filesystem::path& folder) const {
  write_model(folder, model_);
}

}  // namespace weft::dfmf
