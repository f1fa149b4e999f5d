#include "codecs/srbf/srbf_representation.h"

#include <algorithm>
#include <cmath>

#include "btf/raw_appearance.h"
#include "codecs/srbf/lanes.h"

namespace weft::srbf {

namespace {

constexpr std::size_t longest_row = 64 * (3 * most_modes + 3) + wide_lanes;

// cos and sin of four angles, to 1e-7.
struct Turn {
  Vec4 cosine;
  Vec4 sine;
};
Turn turn(const Vec4& angle) {
  const Vec4 shifted = angle * 0.318309886F + 12582912.0F;
  const Vec4 half_turns = shifted - 12582912.0F;
  const Vec4 r = (angle - half_turns * 3.140625F) - half_turns * 9.67653590e-4F;
  const Vec4 q = r * r;
  const Vec4 sine = r * (1 - q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110)))));
  const Vec4 cosine = 1 - q / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56 * (1 - q / 90))));
  const Vec4 halves = half_turns * 0.5F;  // odd ones change the sign
  const Vec4 odd = halves - ((halves + 12582912.0F) - 12582912.0F);
  const Vec4 sign = 1 - 4 * (odd < 0 ? -odd : odd);
  return {cosine * sign, sine * sign};
}

// Equation 3.4 and 3.5 of some kernels: `slot` is [p of each mode, xyz][lane], then colours.
template <std::size_t K, typename Lanes>
void add_kernels(const float* slot, const std::array<float, 3 * K>& psi,
                 std::array<Lanes, 3>& sum) {
  constexpr std::size_t step = sizeof(Lanes) / sizeof(float);
  Lanes exponent{};
  for (std::size_t k = 0; k < K; ++k) {
    Lanes square = Lanes{} + rounding_square;
    for (std::size_t c = 0; c < 3; ++c) {
      const Lanes p = load<Lanes>(slot + (3 * k + c) * step);
      exponent += p * psi[3 * k + c];
      square += p * p;
    }
    exponent -= square_root(square);
  }
  const Lanes value = exp_below_zero(exponent);
  for (std::size_t c = 0; c < 3; ++c) sum[c] += value * load<Lanes>(slot + (3 * K + c) * step);
}

}  // namespace

// Whose numbers a query blends, and how.
struct SrbfRepresentation::Rows {
  std::size_t count;
  std::array<const float*, 8> row;
  std::array<float, 8> weight;
};

SrbfRepresentation::SrbfRepresentation(Model model) : model_(std::move(model)) {
  const Layout layout = model_.layout();
  wides_ = 4 * layout.groups() / wide_lanes;
  angles_at_ = model_.row() - 4;
  row_ = (model_.row() + wide_lanes - 1) / wide_lanes * wide_lanes;
  for (int level = 0; level < model_.sizes().levels(); ++level)
    first_texel_.push_back(model_.sizes().first_texel(level));
  std::vector<std::size_t> place(model_.row());
  for (std::size_t i = 0; i < place.size(); ++i) {
    const std::size_t quad = i / 4;
    const std::size_t group = quad / layout.slots();
    constexpr std::size_t quads = wide_lanes / 4;  // side by side
    place[i] = group < quads * wides_
                   ? wide_lanes * (group / quads * layout.slots() + quad % layout.slots()) +
                         group % quads * 4 + i % 4
                   : i;
  }
  rows_.resize(model_.texels() * row_);
  for (std::size_t texel = 0; texel < model_.texels(); ++texel) {
    for (std::size_t i = 0; i < place.size(); ++i)
      rows_[texel * row_ + place[i]] = model_.values[texel * model_.row() + i] * model_.scale[i];
  }
}

SrbfRepresentation::Rows SrbfRepresentation::rows_around(Texcoord uv, float lod) const {
  const MipSizes sizes = model_.sizes();
  const float top = static_cast<float>(first_texel_.size() - 1);
  const float lambda = lod > 0 ? std::min(lod, top) : 0;  // a NaN is level 0
  const int level = static_cast<int>(lambda);
  const float blend = lambda - static_cast<float>(level);
  Rows rows;
  rows.count = blend > 0 ? 8 : 4;
  for (std::size_t i = 0; i < rows.count; i += 4) {
    const int at = level + (i > 0 ? 1 : 0);
    const TexelStencil texels = bilinear_texels(uv, sizes.width_of(at), sizes.height_of(at));
    for (std::size_t t = 0; t < 4; ++t) {
      rows.row[i + t] = &rows_[(first_texel_[at] + texels.index[t]) * row_];
      rows.weight[i + t] = texels.weight[t] * (i > 0 ? blend : 1 - blend);
    }
  }
  return rows;
}

template <std::size_t K>
Rgb SrbfRepresentation::decode(const Rows& rows, const Direction& light,
                               const Direction& view) const {
  alignas(64) std::array<float, longest_row> numbers;
  for (std::size_t i = 0; i < row_; i += wide_lanes) {
    Wide sum = load<Wide>(rows.row[0] + i) * rows.weight[0];
    for (std::size_t t = 1; t < rows.count; ++t)
      sum += load<Wide>(rows.row[t] + i) * rows.weight[t];
    store(&numbers[i], sum);
  }
  const Turn turned = turn(load<Vec4>(&numbers[angles_at_]));
  std::array<float, 3 * K> psi;
  for (std::size_t k = 0; k < K; ++k) {
    const Direction sum = light * turned.cosine[k] + view * turned.sine[k];
    const float inverse = 1 / std::sqrt((sum ^ sum) + smallest_square);
    for (int c = 0; c < 3; ++c) psi[3 * k + c] = sum[c] * inverse;
  }
  constexpr std::size_t slots = 3 * K + 3;
  std::array<Wide, 3> wide{};
  const float* slot = numbers.data();
  for (std::size_t i = 0; i < wides_; ++i, slot += wide_lanes * slots)
    add_kernels<K>(slot, psi, wide);
  std::array<Vec4, 3> narrow{};
  for (; slot < &numbers[angles_at_]; slot += 4 * slots) add_kernels<K>(slot, psi, narrow);
  Rgb result;
  const float gain = model_.quantity == Quantity::over_cosine ? light.z : 1;
  for (std::size_t c = 0; c < 3; ++c) {
    const float value = (sum_of(wide[c]) + sum_of(narrow[c])) * gain;
    result[static_cast<int>(c)] = value < 0 ? 0 : value;  // a NaN stays one
  }
  return result;
}

Rgb SrbfRepresentation::evaluate(Texcoord uv, Direction light, Direction view, float lod) const {
  Rgb answer;
  const AppearanceQuery query{uv, light, view, lod};
  evaluate({&query, 1}, {&answer, 1});
  return answer;
}

void SrbfRepresentation::prefetch(const Rows& rows) const {
  constexpr std::size_t line = 64 / sizeof(float);
  for (std::size_t t = 0; t < rows.count; ++t) {
    for (std::size_t i = 0; i < row_; i += line) __builtin_prefetch(rows.row[t] + i);
  }
}

// The numbers of the next query are fetched while one is decoded.
template <std::size_t K>
void SrbfRepresentation::decode_all(std::span<const AppearanceQuery> queries,
                                    std::span<Rgb> answers) const {
  if (queries.empty()) return;
  Rows next = rows_around(queries[0].uv, queries[0].lod);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Rows rows = next;
    if (i + 1 < queries.size()) {
      next = rows_around(queries[i + 1].uv, queries[i + 1].lod);
      prefetch(next);
    }
    const AppearanceQuery& q = queries[i];
    answers[i] = q.light.z > 0 && q.view.z > 0 ? decode<K>(rows, q.light, q.view) : Rgb(0, 0, 0);
  }
}

void SrbfRepresentation::evaluate(std::span<const AppearanceQuery> queries,
                                  std::span<Rgb> answers) const {
  switch (model_.shape.modes) {
    case 1:
      return decode_all<1>(queries, answers);
    case 2:
      return decode_all<2>(queries, answers);
    case 3:
      return decode_all<3>(queries, answers);
    default:
      return decode_all<4>(queries, answers);
  }
}

void SrbfRepresentation::save(const std::filesystem::path& folder) const {
  write_model(folder, model_);
}

}  // namespace weft::srbf
