#include "codecs/pca/pca_representation.h"

#include <algorithm>
#include <array>

namespace weft::pca {

namespace {

// Components side by side: sixteen, or eight where there are no more.
using Vec16 = float __attribute__((vector_size(64)));
using Vec8 = float __attribute__((vector_size(32)));
using Vec4 = float __attribute__((vector_size(16)));

template <typename Lanes>
Lanes load(const float* p) {
  Lanes v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
float sum_of(Vec8 v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

float sum_of(Vec16 v) {
  Vec8 low;
  Vec8 high;
  __builtin_memcpy(&low, &v, sizeof low);
  __builtin_memcpy(&high, reinterpret_cast<const char*>(&v) + sizeof low, sizeof high);
  return sum_of(low + high);
}

std::size_t whole_lanes(std::size_t n) {
  return n <= 8 ? 8 : (n + 15) / 16 * 16;
}

}  // namespace

// The pairs that a query asks for, with their weights; those of group g, before end[g + 1], share
// one set of texel weights.
struct PcaRepresentation::Neighbours {
  std::size_t count = 0;
  std::size_t groups = 0;
  std::array<std::size_t, 9> pair;
  std::array<float, 9> weight;
  std::array<std::size_t, 4> end{};
  std::array<std::size_t, 3> set;
};

PcaRepresentation::PcaRepresentation(Model model)
    : model_(std::move(model)),
      view_locator_(model_.head.views),
      light_locator_(model_.head.lights),
      lanes_(whole_lanes(model_.components)) {
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

PcaRepresentation::Neighbours PcaRepresentation::neighbours(const Stencil& views,
                                                            const Stencil& lights,
                                                            float cosine) const {
  Neighbours n;
  for (std::size_t v = 0; v < 3; ++v) {
    if (views.weight[v] == 0) continue;
    for (std::size_t l = 0; l < 3; ++l) {
      if (lights.weight[l] == 0) continue;
      n.pair[n.count] = views.index[v] * model_.head.lights.size() + lights.index[l];
      n.weight[n.count++] = views.weight[v] * lights.weight[l] * cosine;
    }
    if (model_.sets > 1 || n.groups == 0) n.set[n.groups++] = model_.sets > 1 ? views.index[v] : 0;
    n.end[n.groups] = n.count;
  }
  return n;
}

template <typename Lanes>
std::array<float, 3> PcaRepresentation::component_sums(const TexelStencil& texels,
                                                       const Neighbours& n) const {
  constexpr std::size_t step = sizeof(Lanes) / sizeof(float);
  std::array<Lanes, 3> sum{};
  for (std::size_t g = 0; g < n.groups; ++g) {
    const float* set = weights_.data() + n.set[g] * model_.head.texels() * lanes_;
    for (std::size_t k = 0; k < lanes_; k += step) {
      Lanes weight{};
      for (std::size_t t = 0; t < 4; ++t)
        weight += load<Lanes>(set + texels.index[t] * lanes_ + k) * texels.weight[t];
      std::array<Lanes, 3> value{};
      for (std::size_t i = n.end[g]; i < n.end[g + 1]; ++i) {
        const float* basis = basis_.data() + 3 * n.pair[i] * lanes_ + k;
        for (std::size_t c = 0; c < 3; ++c)
          value[c] += load<Lanes>(basis + c * lanes_) * n.weight[i];
      }
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * value[c];
    }
  }
  return {sum_of(sum[0]), sum_of(sum[1]), sum_of(sum[2])};
}

Rgb PcaRepresentation::decode(const TexelStencil& texels, const Stencil& views,
                              const Stencil& lights, float cosine) const {
  const Neighbours n = neighbours(views, lights, cosine);
  Vec4 mean{};
  for (std::size_t i = 0; i < n.count; ++i) mean += load<Vec4>(&mean_[4 * n.pair[i]]) * n.weight[i];
  const std::array<float, 3> sum =
      lanes_ == 8 ? component_sums<Vec8>(texels, n) : component_sums<Vec16>(texels, n);
  Rgb result;
  for (int c = 0; c < 3; ++c) {
    const float value = mean[c] + sum[c];
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
