#include "codecs/pca/pca_representation.h"

#include <algorithm>
#include <array>

#include "codecs/wide_vector.h"

namespace weft::pca {

namespace {

std::size_t whole_lanes(std::size_t n) {
  return n <= 8 ? 8 : (n + 15) / 16 * 16;
}

}  // namespace

PcaRepresentation::PcaRepresentation(Model model)
    : model_(std::move(model)),
      view_locator_(model_.head.views),
      light_locator_(model_.head.lights),
      inverse_cosines_(inverse_cosines(model_.head.lights)),
      lanes_(whole_lanes(model_.components)) {
  const std::size_t padded = model_.padded();
  const std::size_t rows = model_.weights.size() / padded;
  weights_.resize(rows * lanes_);
  for (std::size_t row = 0; row < rows; ++row)
    std::copy_n(&model_.weights[row * padded], padded, &weights_[row * lanes_]);

  const std::size_t n_lights = model_.head.lights.size();
  basis_.resize(3 * model_.head.pairs() * lanes_);
  mean_.resize(4 * model_.head.pairs());
  for (std::size_t pair = 0; pair < model_.head.pairs(); ++pair) {
    const float* scale = model_.scale.data() + (model_.sets == 1 ? 0 : pair / n_lights) * padded;
    for (std::size_t c = 0; c < 3; ++c) {
      mean_[4 * pair + c] = model_.mean[4 * pair + c] * model_.mean_scale;
      for (std::size_t k = 0; k < padded; ++k)
        basis_[(3 * pair + c) * lanes_ + k] = model_.basis[(3 * pair + c) * padded + k] * scale[k];
    }
  }
}

template <typename Row>
Rgb PcaRepresentation::decode(const TexelStencil& texels, const PairLane& pairs) const {
  constexpr std::size_t step = sizeof(Row) / sizeof(float);
  const std::size_t lanes = step == 8 ? 8 : lanes_;
  const std::size_t groups = model_.sets > 1 ? 3 : 1;  // of pairs, with one set of weights each
  const std::size_t views_a_group = 3 / groups;
  std::array<Row, 3> sum{};
  for (std::size_t g = 0; g < groups; ++g) {
    const std::size_t set = groups > 1 ? pairs.view[g] : 0;
    const float* rows = weights_.data() + set * model_.head.texels() * lanes;
    for (std::size_t k = 0; k < lanes; k += step) {
      Row weight{};
      for (std::size_t t = 0; t < 4; ++t)
        weight += load<Row>(rows + texels.index[t] * lanes + k) * texels.weight[t];
      std::array<Row, 3> value{};
      for (std::size_t v = g * views_a_group; v < (g + 1) * views_a_group; ++v) {
        for (std::size_t i = 4 * v; i < 4 * v + 3; ++i) {
          const float* basis = basis_.data() + 3 * pairs.index[i] * lanes + k;
          for (std::size_t c = 0; c < 3; ++c)
            value[c] += load<Row>(basis + c * lanes) * pairs.weight[i];
        }
      }
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * value[c];
    }
  }
  Vec4 mean{};
  for (std::size_t v = 0; v < 3; ++v) {
    for (std::size_t i = 4 * v; i < 4 * v + 3; ++i)
      mean += load<Vec4>(&mean_[4 * pairs.index[i]]) * pairs.weight[i];
  }
  Rgb result;
  for (int c = 0; c < 3; ++c) {
    const float value = mean[c] + sum_of(sum[c]);
    result[c] = value < 0 ? 0 : value;  // a NaN stays one
  }
  return result;
}

Rgb PcaRepresentation::evaluate(Texcoord uv, Direction light, Direction view, float /*lod*/) const {
  if (!(light.z > 0) || !(view.z > 0)) return {0, 0, 0};
  const TexelStencil texels = bilinear_texels(uv, model_.head.width, model_.head.height);
  const PairLane pairs = pair_lane(model_.head.views.locate(view), model_.head.lights.locate(light),
                                   inverse_cosines_, light.z);
  return lanes_ == 8 ? decode<Vec8>(texels, pairs) : decode<Vec16>(texels, pairs);
}

void PcaRepresentation::evaluate(std::span<const AppearanceQuery> queries,
                                 std::span<Rgb> answers) const {
  decode_in_batches(queries, answers, [this](const QueryBatch& batch) {
    return lanes_ == 8 ? decode<Vec8>(batch) : decode<Vec16>(batch);
  });
}

template <typename Row>
Batch<Rgb> PcaRepresentation::decode(const QueryBatch& batch) const {
  const TexelBatch texels = texel_batch(batch, model_.head.width, model_.head.height);
  const Batch<PairLane> pairs = pair_batch(view_locator_.locate(model_.head.views, batch.view),
                                           light_locator_.locate(model_.head.lights, batch.light),
                                           inverse_cosines_, batch.light.z);
  Batch<Rgb> values;
  for (std::size_t i = 0; i < batch_lanes; ++i) values[i] = decode<Row>(texels.lane(i), pairs[i]);
  return values;
}

std::size_t PcaRepresentation::constant_bytes() const {
  return direction_table_bytes(model_.head) +
         (model_.scale.size() + model_.head.lights.size()) * sizeof(float);
}

void PcaRepresentation::save(const std::filesystem::path& folder) const {
  write_model(folder, model_);
}

}  // namespace weft::pca
