#include "codecs/dfmf/dfmf_representation.h"

#include <algorithm>
#include <array>

#include "btf/raw_appearance.h"
#include "codecs/branchless_exp.h"
#include "codecs/dfmf/colour.h"

namespace weft::dfmf {

namespace {

// Four texels side by side.
using Vec4 = float __attribute__((vector_size(16)));

constexpr std::size_t most_slots = 3 * 256;

}  // namespace

DfmfRepresentation::DfmfRepresentation(Model model)
    : model_(std::move(model)),
      view_locator_(model_.head.views),
      light_locator_(model_.head.lights),
      ones_(model_.head.lights.size(), 1.0F),
      basis_(model_.basis) {
  for (std::size_t i = 0; i < basis_.size(); ++i) basis_[i] *= model_.scale[i % model_.slots()];
}

Rgb DfmfRepresentation::decode(const TexelStencil& texels, const PairLane& neighbours) const {
  const std::size_t slots = model_.slots();
  alignas(64) std::array<Vec4, most_slots> weights;  // one lane a texel
  for (std::size_t t = 0; t < 4; ++t) {
    const float* row = &model_.weights[texels.index[t] * slots];
    for (std::size_t s = 0; s < slots; ++s) weights[s][t] = row[s];
  }
  alignas(64) std::array<std::array<Vec4, 9>, 3> channel;  // a, b, c of each pair
  alignas(64) std::array<Vec4, 9> share{};
  const Vec4 texel_weight{texels.weight[0], texels.weight[1], texels.weight[2], texels.weight[3]};
  std::size_t pairs = 0;
  for (std::size_t v = 0; v < 3; ++v) {
    for (std::size_t l = 0; l < 3; ++l) {
      const float weight = neighbours.weight[4 * v + l];
      const float* basis = &basis_[neighbours.index[4 * v + l] * slots];
      std::size_t s = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        Vec4 even{};
        Vec4 odd{};
        for (const std::size_t end = model_.first_slot(c + 1); s < end; s += 2) {
          even += basis[s] * weights[s];
          odd += basis[s + 1] * weights[s + 1];
        }
        channel[c][pairs] = even + odd;
      }
      share[pairs++] = texel_weight * weight;
    }
  }
  const float epsilon = model_.epsilon;
  float red = 0;
  float green = 0;
  float blue = 0;
  const auto* a = reinterpret_cast<const float*>(channel[0].data());
  const auto* b = reinterpret_cast<const float*>(channel[1].data());
  const auto* c = reinterpret_cast<const float*>(channel[2].data());
  const auto* w = reinterpret_cast<const float*>(share.data());
  alignas(64) std::array<float, 36> bright;  // Y + epsilon
  for (std::size_t i = 0; i < 4 * pairs; ++i) bright[i] = epsilon * branchless_exp(a[i]);
  for (std::size_t i = 0; i < 4 * pairs; ++i) {
    const float y = bright[i] - epsilon;
    const float u = b[i] * bright[i];
    const float v = c[i] * bright[i];
    red += w[i] * std::max(0.0F, y + red_of_v * v);
    green += w[i] * std::max(0.0F, y - green_of_u * u - green_of_v * v);
    blue += w[i] * std::max(0.0F, y + blue_of_u * u);
  }
  return {red, green, blue};
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
    for (std::size_t i = 0; i < batch_lanes; ++i) values[i] = decode(texels.lane(i), pairs[i]);
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
