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

// What every mode's directions are multiplied by, over the length: modes lie side by side, those of
// several texels one after the other.
template <typename Lanes>
using Psi = std::array<Lanes, 3>;  // [xyz]
// A call would empty the vector registers.
template <typename Lanes>
[[gnu::always_inline]] inline Psi<Lanes> variables(const Lanes& cosine, const Lanes& sine,
                                                   const Direction& light, const Direction& view) {
  Psi<Lanes> psi;
  Lanes square = Lanes{} + smallest_square;
  for (int c = 0; c < 3; ++c) {
    psi[c] = cosine * light[c] + sine * view[c];
    square += psi[c] * psi[c];
  }
  const Lanes inverse = 1 / square_root(square);
  for (Lanes& of : psi) of *= inverse;
  return psi;
}

// The same quad of as many texels as a vector holds.
using TexelQuads = std::array<const float*, wide_quads>;
[[gnu::always_inline]] inline Wide side_by_side(TexelQuads texels, std::size_t first) {
  for (const float*& texel : texels) texel += first;
  return quads_at(texels);
}

// Each of four numbers four times.
inline auto spread(const Vec4& v) {
  const Vec8 low = __builtin_shufflevector(v, v, 0, 0, 0, 0, 1, 1, 1, 1);
  const Vec8 high = __builtin_shufflevector(v, v, 2, 2, 2, 2, 3, 3, 3, 3);
#ifdef __AVX512F__
  return std::array{joined(low, high)};
#else
  return std::array{low, high};
#endif
}

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

// Red, green and blue, of some kernels side by side.
template <typename Lanes>
struct Sums {
  Lanes rgb[3] = {};  // NOLINT
};

// Modes' psi of up to four texels, [xyz][texel][mode].
using PsiNumbers = std::array<float, 48>;
constexpr std::size_t psi_place(std::size_t texel, std::size_t mode, std::size_t c) {
  return 16 * c + 4 * texel + mode;
}

// Equations 3.4 and 3.5 of some kernels of several texels, which wait for one another least where
// each step is taken for all. `slot` of a texel is [slot][lane]; that of the next query's is
// fetched on the way, a line a step: asked for all at once, memory would stop everything else.
template <std::size_t K, std::size_t texels, Filtering filtering, typename Lanes>
[[gnu::always_inline]] inline void add_kernels(const std::array<const float*, texels>& slot,
                                               const std::array<const float*, texels>& next,
                                               const PsiNumbers& psi, const float* weight,
                                               Sums<Lanes>& sums) {
  constexpr std::size_t step = sizeof(Lanes) / sizeof(float);
  std::array<Lanes, texels> exponent;
  for (std::size_t t = 0; t < texels; ++t) {
    if constexpr (filtering == Filtering::values)
      exponent[t] = Lanes{} - load<Lanes>(slot[t] + 3 * K * step);
    else
      exponent[t] = minus_lengths<K, Lanes>(slot[t]);
  }
  for (std::size_t m = 0; m < 3 * K; ++m) {
    for (std::size_t t = 0; t < texels; ++t) {
      if constexpr (filtering == Filtering::values) __builtin_prefetch(next[t] + m * step);
      exponent[t] += load<Lanes>(slot[t] + m * step) * psi[psi_place(t, m / 3, m % 3)];
    }
  }
  constexpr std::size_t colour = (slots_of(K, filtering) - 3) * step;
  for (std::size_t t = 0; t < texels; ++t) {
    const Lanes value = exp_below_zero(exponent[t]) * weight[t];
    if constexpr (filtering == Filtering::values) {
      for (std::size_t m = 3 * K; m < slots_of(K, filtering); ++m)
        __builtin_prefetch(next[t] + m * step);
    }
    for (std::size_t c = 0; c < 3; ++c)
      sums.rgb[c] += value * load<Lanes>(slot[t] + colour + c * step);
  }
}

// Four kernels of each of several texels at once, [slot][4] from `first` on.
template <std::size_t K>
[[gnu::always_inline]] inline void add_quads(const TexelQuads& texels, std::size_t first,
                                             const Psi<Wide>& psi, const Wide& weight,
                                             Sums<Wide>& sums) {
  Wide exponent = Wide{} - side_by_side(texels, first + 3 * K * 4);
  const auto add_mode = [&]<std::size_t k>(std::integral_constant<std::size_t, k>) {
    for (std::size_t c = 0; c < 3; ++c)
      exponent += side_by_side(texels, first + (3 * k + c) * 4) * of_each_quad<k>(psi[c]);
  };
  [&]<std::size_t... k>(std::index_sequence<k...>) {
    (add_mode(std::integral_constant<std::size_t, k>{}), ...);
  }
  (std::make_index_sequence<K>{});
  const Wide value = exp_below_zero(exponent) * weight;
  constexpr std::size_t colour = (slots_of(K, Filtering::values) - 3) * 4;
  for (std::size_t c = 0; c < 3; ++c)
    sums.rgb[c] += value * side_by_side(texels, first + colour + 4 * c);
}

// What four texels' kernels sum up to. Those beyond a multiple of the lanes are summed up for
// several texels at once.
template <std::size_t K>
[[gnu::always_inline]] inline void add_texels(const RowPlaces& places, const float* const* row,
                                              const float* const* next_row, const float* weight,
                                              const Direction& light, const Direction& view,
                                              Sums<Wide>& sums) {
  constexpr std::size_t slots = slots_of(K, Filtering::values);
  constexpr std::size_t parts = 4 / wide_quads;
  std::array<TexelQuads, parts> texels;
  std::array<Psi<Wide>, parts> psi;
  alignas(64) PsiNumbers numbers;
  for (std::size_t i = 0; i < parts; ++i) {
    std::copy_n(row + i * wide_quads, wide_quads, texels[i].begin());
    psi[i] = variables(side_by_side(texels[i], places.angles_at),
                       side_by_side(texels[i], places.angles_at + 4), light, view);
    for (std::size_t c = 0; c < 3; ++c) store(&numbers[psi_place(i * wide_quads, 0, c)], psi[i][c]);
  }
  // The quads first: what was just written side by side would have to be waited for if it were read
  // number by number.
  const std::array<Wide, parts> weights = spread(load<Vec4>(weight));
  for (std::size_t i = 0; i < places.narrows; ++i) {
    const std::size_t first = (places.wides * wide_lanes + 4 * i) * slots;
    for (std::size_t part = 0; part < parts; ++part)
      add_quads<K>(texels[part], first, psi[part], weights[part], sums);
  }
  std::array<const float*, 4> slot;
  std::array<const float*, 4> next;
  std::copy_n(row, 4, slot.begin());
  std::copy_n(next_row, 4, next.begin());
  for (std::size_t i = 0; i < places.wides; ++i) {
    add_kernels<K, 4, Filtering::values>(slot, next, numbers, weight, sums);
    for (const float*& at : slot) at += wide_lanes * slots;
    for (const float*& at : next) at += wide_lanes * slots;
  }
  for (const float* at : next)
    for (std::size_t i = 0; i < places.size - places.wides * wide_lanes * slots; i += wide_lanes)
      __builtin_prefetch(at + i);
}

// What the kernels sum up to whose numbers are the texels' blended ones.
template <std::size_t K>
[[gnu::always_inline]] inline void add_blended(const RowPlaces& places, const Rows& rows,
                                               const Rows& next, const Direction& light,
                                               const Direction& view, Sums<Wide>& sums) {
  constexpr std::size_t slots = slots_of(K, Filtering::numbers);
  alignas(64) std::array<float, longest_row> row;
  for (std::size_t i = 0; i < places.size; i += wide_lanes) {
    Wide sum = load<Wide>(rows.row[0] + i) * rows.weight[0];
    for (std::size_t t = 0; t < next.count; ++t) __builtin_prefetch(next.row[t] + i);
    for (std::size_t t = 1; t < rows.count; ++t)
      sum += load<Wide>(rows.row[t] + i) * rows.weight[t];
    store(&row[i], sum);
  }
  const Turn turned = turn(load<Vec4>(&row[places.angles_at]));
  const Psi<Vec4> psi = variables(turned.cosine, turned.sine, light, view);
  PsiNumbers numbers;
  for (std::size_t c = 0; c < 3; ++c) store(&numbers[psi_place(0, 0, c)], psi[c]);
  constexpr float all = 1;
  std::array<const float*, 1> slot{row.data()};
  for (std::size_t i = 0; i < places.wides; ++i, slot[0] += wide_lanes * slots)
    add_kernels<K, 1, Filtering::numbers>(slot, slot, numbers, &all, sums);
  Sums<Vec4> narrow;
  for (std::size_t i = 0; i < places.narrows; ++i, slot[0] += 4 * slots)
    add_kernels<K, 1, Filtering::numbers>(slot, slot, numbers, &all, narrow);
  for (std::size_t c = 0; c < 3; ++c) sums.rgb[c][0] += sum_of(narrow.rgb[c]);
}

}  // namespace

SrbfRepresentation::SrbfRepresentation(Model model) : model_(std::move(model)) {
  for (int level = 0; level < model_.sizes().levels(); ++level)
    first_texel_.push_back(model_.sizes().first_texel(level));
  const Layout layout = model_.layout();
  const std::size_t slots = slots_of(model_.shape.modes, model_.filtering);
  const std::size_t angles = model_.filtering == Filtering::values ? 8 : 4;
  places_.wides = 4 * layout.groups() / wide_lanes;
  places_.narrows = layout.groups() - places_.wides * wide_lanes / 4;
  places_.angles_at = 4 * layout.groups() * slots;
  places_.size = (places_.angles_at + angles + wide_lanes - 1) / wide_lanes * wide_lanes;
  rows_.resize(model_.texels() * places_.size);
  for (std::size_t texel = 0; texel < model_.texels(); ++texel) fill_row(texel);
}

void SrbfRepresentation::fill_row(std::size_t texel) {
  const Layout layout = model_.layout();
  const std::size_t modes = model_.shape.modes;
  const std::size_t slots = slots_of(modes, model_.filtering);
  const float* values = &model_.values[texel * model_.row()];
  float* row = &rows_[texel * places_.size];
  const auto number = [&](std::size_t place) { return values[place] * model_.scale[place]; };
  for (std::size_t j = 0; j < 4 * layout.groups(); ++j) {
    const bool is_wide = j < places_.wides * wide_lanes;
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
    float* to = row + places_.angles_at + k;
    if (model_.filtering == Filtering::values) {
      to[0] = std::cos(angle);
      to[4] = std::sin(angle);
    } else {
      to[0] = angle;
    }
  }
}

Rows SrbfRepresentation::rows_around(Texcoord uv, float lod) const {
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
      rows.row[i + t] = &rows_[(first_texel_[at] + texels.index[t]) * places_.size];
      rows.weight[i + t] = texels.weight[t] * (i > 0 ? blend : 1 - blend);
    }
  }
  return rows;
}

template <std::size_t K, Filtering filtering>
Rgb SrbfRepresentation::decode(const Rows& rows, const Rows& next, const Direction& light,
                               const Direction& view) const {
  Sums<Wide> sums;
  if constexpr (filtering == Filtering::values) {
    for (std::size_t i = 0; i < rows.count; i += 4)
      add_texels<K>(places_, &rows.row[i], &next.row[next.count == rows.count ? i : 0],
                    &rows.weight[i], light, view, sums);
  } else {
    add_blended<K>(places_, rows, next, light, view, sums);
  }
  Rgb result;
  const float gain = model_.quantity == Quantity::over_cosine ? light.z : 1;
  for (int c = 0; c < 3; ++c) {
    const float value = sum_of(sums.rgb[c]) * gain;
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

template <std::size_t K, Filtering filtering>
void SrbfRepresentation::decode_all(std::span<const AppearanceQuery> queries,
                                    std::span<Rgb> answers) const {
  if (queries.empty()) return;
  Rows next = rows_around(queries[0].uv, queries[0].lod);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Rows rows = next;
    if (i + 1 < queries.size()) {
      next = rows_around(queries[i + 1].uv, queries[i + 1].lod);
    }
    const AppearanceQuery& q = queries[i];
    answers[i] = q.light.z > 0 && q.view.z > 0 ? decode<K, filtering>(rows, next, q.light, q.view)
                                               : Rgb(0, 0, 0);
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
