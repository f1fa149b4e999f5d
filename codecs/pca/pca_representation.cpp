#include "codecs/pca/pca_representation.h"

#include <algorithm>
#include <array>

namespace weft::pca {

namespace {

// Eight components side by side: one register, also where there is no AVX-512.
using Vec8 = float __attribute__((vector_size(32)));
using Vec4 = float __attribute__((vector_size(16)));

Vec8 load8(const float* p) {
  Vec8 v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
Vec4 load4(const float* p) {
  Vec4 v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
float sum_of(Vec8 v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

struct WeightedPair {
  std::size_t pair;
  float weight;
};

std::size_t multiple_of_eight(std::size_t n) {
  return (n + 7) / 8 * 8;
}

}  // namespace

PcaRepresentation::PcaRepresentation(Model model)
    : model_(std::move(model)),
      view_locator_(model_.head.views),
      light_locator_(model_.head.lights),
      lanes_(multiple_of_eight(model_.components)) {
  const std::size_t padded = model_.padded();
  const std::size_t rows = model_.weights.size() / padded;
  weights_.resize(rows * lanes_);
  for (std::size_t row = 0; row < rows; ++row)
    std::copy_n(&model_.weights[row * padded], padded, &weights_[row * lanes_]);

  const std::vector<float> inverse = inverse_cosines(model_.head.lights);
  const std::size_t n_lights = model_.head.lights.size();
  basis_.resize(3 * model_.head.pairs() * lanes_);
  mean_.resize(4 * model_.head.pairs());
  for (std::size_t pair = 0; pair < model_.head.pairs(); ++pair) {
    const float* scale = model_.scale.data() + (model_.sets == 1 ? 0 : pair / n_lights) * padded;
    const float over_cosine = inverse[pair % n_lights];
    for (std::size_t c = 0; c < 3; ++c) {
      mean_[4 * pair + c] = model_.mean[4 * pair + c] * model_.mean_scale * over_cosine;
      for (std::size_t k = 0; k < padded; ++k) {
        basis_[(3 * pair + c) * lanes_ + k] =
            model_.basis[(3 * pair + c) * padded + k] * scale[k] * over_cosine;
      }
    }
  }
}

// About 30 ns of flat loops at 16 components, where two calls of `locate` take 60.
Rgb PcaRepresentation::decode(const TexelStencil& texels, const Stencil& views,
                              const Stencil& lights, float cosine) const {
  std::array<WeightedPair, 9> pairs;
  std::array<std::size_t, 4> group_end{};  // pairs that share their weights: all, or a view's
  std::array<std::size_t, 3> group_set{};
  std::size_t groups = 0;
  std::size_t count = 0;
  for (std::size_t v = 0; v < 3; ++v) {
    if (views.weight[v] == 0) continue;
    for (std::size_t l = 0; l < 3; ++l) {
      if (lights.weight[l] == 0) continue;
      pairs[count++] = {views.index[v] * model_.head.lights.size() + lights.index[l],
                        views.weight[v] * lights.weight[l] * cosine};
    }
    if (model_.sets > 1 || groups == 0) group_set[groups++] = model_.sets > 1 ? views.index[v] : 0;
    group_end[groups] = count;
  }

  Vec4 mean{};
  for (std::size_t i = 0; i < count; ++i)
    mean += load4(&mean_[4 * pairs[i].pair]) * pairs[i].weight;
  std::array<Vec8, 3> sum{};
  for (std::size_t g = 0; g < groups; ++g) {
    const float* set = weights_.data() + group_set[g] * model_.head.texels() * lanes_;
    for (std::size_t k = 0; k < lanes_; k += 8) {
      Vec8 weight{};
      for (std::size_t t = 0; t < 4; ++t)
        weight += load8(set + texels.index[t] * lanes_ + k) * texels.weight[t];
      std::array<Vec8, 3> value{};
      for (std::size_t i = group_end[g]; i < group_end[g + 1]; ++i) {
        const float* basis = basis_.data() + 3 * pairs[i].pair * lanes_ + k;
        for (std::size_t c = 0; c < 3; ++c) value[c] += load8(basis + c * lanes_) * pairs[i].weight;
      }
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * value[c];
    }
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
  return decode(bilinear_texels(uv, model_.head.width, model_.head.height),
                model_.head.views.locate(view), model_.head.lights.locate(light), light.z);
}

void PcaRepresentation::evaluate(std::span<const AppearanceQuery> queries,
                                 std::span<Rgb> answers) const {
  decode_in_batches(
      model_.head.views, view_locator_, model_.head.lights, light_locator_, queries, answers,
      [&](const AppearanceQuery& query, const Stencil& views, const Stencil& lights) {
        return decode(bilinear_texels(query.uv, model_.head.width, model_.head.height), views,
                      lights, query.light.z);
      });
}

std::size_t PcaRepresentation::constant_bytes() const {
  return direction_table_bytes(model_.head) +
         (model_.scale.size() + model_.head.lights.size()) * sizeof(float);
}

void PcaRepresentation::save(const std::filesystem::path& folder) const {
  write_model(folder, model_);
}

}  // namespace weft::pca
