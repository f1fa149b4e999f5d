#include "codecs/srbf/srbf_representation.h"

#include <algorithm>
#include <cmath>

#include "btf/raw_appearance.h"
#include "codecs/srbf/lanes.h"

namespace weft::srbf {

namespace {

constexpr std::size_t longest_row = 64 * (3 * most_modes + 3) + wide_lanes;

// Of a kernel: p of each mode, the sum of their lengths where it is kept, the colour.
constexpr std::size_t slots_of(std::size_t modes, Filtering filtering) {
  return 3 * modes + 3 + (filtering == Filtering::values ? 1 : 0);
}

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

// Every mode's psi: [xyz][mode]. A call would empty the vector registers.
using Psi = std::array<float, 12>;
[[gnu::always_inline]] inline Psi variables(const Turn& turned, const Direction& light,
                                            const Direction& view) {
  std::array<Vec4, 3> sum;
  Vec4 square = Vec4{} + smallest_square;
  for (int c = 0; c < 3; ++c) {
    sum[c] = turned.cosine * light[c] + turned.sine * view[c];
    square += sum[c] * sum[c];
  }
  const Vec4 inverse = 1 / square_root(square);
  Psi psi;
  for (std::size_t c = 0; c < 3; ++c) store(&psi[4 * c], sum[c] * inverse);
  return psi;
}

template <typename Lanes>
struct Sums {
  Lanes rgb[3] = {};  // NOLINT
};

template <std::size_t K, typename Lanes>
[[gnu::always_inline]] inline Lanes minus_lengths(const float* slot) {
  constexpr std::size_t step = sizeof(Lanes) / sizeof(float);
  Lanes sum{};
  for (std::size_t k = 0; k < K; ++k) {
    Lanes square = Lanes{} + rounding_square;
    for (std::size_t c = 0; c < 3; ++c) {
      const Lanes p = load<Lanes>(slot + (3 * k + c) * step);
      square += p * p;
    }
    sum -= square_root(square);
  }
  return sum;
}

// Equations 3.4 and 3.5 of some kernels of several texels, which wait for one another least where
// each step is taken for all. `slot` of a texel is [slot][lane].
template <std::size_t K, std::size_t texels, Filtering filtering, typename Lanes>
[[gnu::always_inline]] inline void add_kernels(const std::array<const float*, texels>& slot,
                                               const std::array<Psi, texels>& psi,
                                               const float* weight, Sums<Lanes>& sums) {
  constexpr std::size_t step = sizeof(Lanes) / sizeof(float);
  std::array<Lanes, texels> exponent;
  for (std::size_t t = 0; t < texels; ++t) {
    if constexpr (filtering == Filtering::values)
      exponent[t] = Lanes{} - load<Lanes>(slot[t] + 3 * K * step);
    else
      exponent[t] = minus_lengths<K, Lanes>(slot[t]);
  }
  for (std::size_t m = 0; m < 3 * K; ++m) {
    for (std::size_t t = 0; t < texels; ++t)
      exponent[t] += load<Lanes>(slot[t] + m * step) * psi[t][m % 3 * 4 + m / 3];
  }
  constexpr std::size_t colour = (slots_of(K, filtering) - 3) * step;
  for (std::size_t t = 0; t < texels; ++t) {
    const Lanes value = exp_below_zero(exponent[t]) * weight[t];
    for (std::size_t c = 0; c < 3; ++c)
      sums.rgb[c] += value * load<Lanes>(slot[t] + colour + c * step);
  }
}

}  // namespace

// The texels that a query blends, and how.
struct SrbfRepresentation::Rows {
  std::size_t count;
  std::array<const float*, 8> row;
  std::array<float, 8> weight;
};

SrbfRepresentation::SrbfRepresentation(Model model) : model_(std::move(model)) {
  for (int level = 0; level < model_.sizes().levels(); ++level)
    first_texel_.push_back(model_.sizes().first_texel(level));
  const Layout layout = model_.layout();
  const std::size_t slots = slots_of(model_.shape.modes, model_.filtering);
  const std::size_t angles = model_.filtering == Filtering::values ? 8 : 4;
  wides_ = 4 * layout.groups() / wide_lanes;
  narrows_ = layout.groups() - wides_ * wide_lanes / 4;
  angles_at_ = 4 * layout.groups() * slots;
  row_ = (angles_at_ + angles + wide_lanes - 1) / wide_lanes * wide_lanes;
  rows_.resize(model_.texels() * row_);
  for (std::size_t texel = 0; texel < model_.texels(); ++texel) fill_row(texel);
}

void SrbfRepresentation::fill_row(std::size_t texel) {
  const Layout layout = model_.layout();
  const std::size_t modes = model_.shape.modes;
  const std::size_t slots = slots_of(modes, model_.filtering);
  const float* values = &model_.values[texel * model_.row()];
  float* row = &rows_[texel * row_];
  const auto number = [&](std::size_t place) { return values[place] * model_.scale[place]; };
  for (std::size_t j = 0; j < 4 * layout.groups(); ++j) {
    const bool is_wide = j < wides_ * wide_lanes;
    const std::size_t lanes = is_wide ? wide_lanes : 4;
    float* lane = row + j / lanes * lanes * slots + j % lanes;
    double lengths = 0;
    for (std::size_t k = 0; k < modes; ++k) {
      std::array<double, 3> p;
      for (std::size_t c = 0; c < 3; ++c) {
        p[c] = number(layout.place(j, 3 * k + c));
        lane[(3 * k + c) * lanes] = static_cast<float>(p[c]);
      }
      lengths += smooth_length(p[0], p[1], p[2]);
    }
    for (std::size_t c = 0; c < 3; ++c)
      lane[(slots - 3 + c) * lanes] = number(layout.place(j, 3 * modes + c));
    if (model_.filtering == Filtering::values)
      lane[3 * modes * lanes] = static_cast<float>(lengths);
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const float angle = number(layout.angle_place(k));
    float* to = row + angles_at_ + k;
    if (model_.filtering == Filtering::values) {
      to[0] = std::cos(angle);
      to[4] = std::sin(angle);
    } else {
      to[0] = angle;
    }
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

template <std::size_t K, Filtering filtering>
Rgb SrbfRepresentation::decode(const Rows& rows, const Direction& light,
                               const Direction& view) const {
  Sums<Wide> wide;
  Sums<Vec4> narrow;
  constexpr std::size_t slots = slots_of(K, filtering);
  constexpr std::size_t texels = filtering == Filtering::values ? 4 : 1;
  const auto add_rows = [&](std::array<const float*, texels> slot,
                            const std::array<Turn, texels>& turned, const float* weight) {
    std::array<Psi, texels> psi;
    for (std::size_t t = 0; t < texels; ++t) psi[t] = variables(turned[t], light, view);
    for (std::size_t i = 0; i < wides_; ++i) {
      add_kernels<K, texels, filtering>(slot, psi, weight, wide);
      for (const float*& at : slot) at += wide_lanes * slots;
    }
    for (std::size_t i = 0; i < narrows_; ++i) {
      add_kernels<K, texels, filtering>(slot, psi, weight, narrow);
      for (const float*& at : slot) at += 4 * slots;
    }
  };
  if constexpr (filtering == Filtering::values) {
    for (std::size_t i = 0; i < rows.count; i += texels) {
      std::array<const float*, texels> row;
      std::array<Turn, texels> turned;
      for (std::size_t t = 0; t < texels; ++t) {
        row[t] = rows.row[i + t];
        const float* at = row[t] + angles_at_;
        turned[t] = {load<Vec4>(at), load<Vec4>(at + 4)};
      }
      add_rows(row, turned, &rows.weight[i]);
    }
  } else {
    alignas(64) std::array<float, longest_row> numbers;
    for (std::size_t i = 0; i < row_; i += wide_lanes) {
      Wide sum = load<Wide>(rows.row[0] + i) * rows.weight[0];
      for (std::size_t t = 1; t < rows.count; ++t)
        sum += load<Wide>(rows.row[t] + i) * rows.weight[t];
      store(&numbers[i], sum);
    }
    constexpr float all = 1;
    add_rows({numbers.data()}, {turn(load<Vec4>(&numbers[angles_at_]))}, &all);
  }
  Rgb result;
  const float gain = model_.quantity == Quantity::over_cosine ? light.z : 1;
  for (int c = 0; c < 3; ++c) {
    const float value = (sum_of(wide.rgb[c]) + sum_of(narrow.rgb[c])) * gain;
    result[c] = value < 0 ? 0 : value;  // a NaN stays one
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
template <std::size_t K, Filtering filtering>
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
    answers[i] =
        q.light.z > 0 && q.view.z > 0 ? decode<K, filtering>(rows, q.light, q.view) : Rgb(0, 0, 0);
  }
}

template <std::size_t K>
void SrbfRepresentation::decode_modes(std::span<const AppearanceQuery> queries,
                                      std::span<Rgb> answers) const {
  if (model_.filtering == Filtering::values)
    decode_all<K, Filtering::values>(queries, answers);
  else
    decode_all<K, Filtering::numbers>(queries, answers);
}

void SrbfRepresentation::evaluate(std::span<const AppearanceQuery> queries,
                                  std::span<Rgb> answers) const {
  switch (model_.shape.modes) {
    case 1:
      return decode_modes<1>(queries, answers);
    case 2:
      return decode_modes<2>(queries, answers);
    case 3:
      return decode_modes<3>(queries, answers);
    default:
      return decode_modes<4>(queries, answers);
  }
}

void SrbfRepresentation::save(const std::filesystem::path& folder) const {
  write_model(folder, model_);
}

}  // namespace weft::srbf
