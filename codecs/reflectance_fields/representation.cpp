#include "codecs/reflectance_fields/representation.h"

#ifdef __F16C__
#include <immintrin.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "btf/raw_appearance.h"
#include "codecs/branchless_exp.h"
#include "codecs/transposed_lanes.h"
#include "codecs/wide_vector.h"

namespace weft::reflectance_fields {

namespace {

// Fields side by side, of four texels and as many views as the CPU takes: a row is one texel, its
// quads are those views'.
constexpr std::size_t views_at_once = wide_quads;
using Rows = std::array<Wide, 4>;

inline Wide at_least_zero(Wide x) {
  return x < 0.0F ? Wide{} : x;  // a NaN stays one
}

// A quad of each of the views' fields. In registers: written one by one to memory, they could not
// be read as one before all are there.
inline Wide row_of(const std::array<const float*, views_at_once>& quads) {
  return quads_at(quads);
}

inline Wide row_of(const std::array<const half*, views_at_once>& quads) {
#ifdef __F16C__
  const auto two = [&](std::size_t i) {
    return _mm_loadh_pi((__m128)_mm_loadl_epi64((const __m128i*)quads[i]),
                        (const __m64*)quads[i + 1]);
  };
#ifdef __AVX512F__
  // Unmasked, GCC 12 takes its own header for uninitialised (its bug 105593).
  return (Wide)_mm512_maskz_cvtph_ps(
      0xFFFF, (__m256i)_mm256_insertf128_ps(_mm256_castps128_ps256(two(0)), two(2), 1));
#else
  return (Wide)_mm256_cvtph_ps((__m128i)two(0));
#endif
#else
  Wide row;
  for (std::size_t i = 0; i < wide_lanes; ++i) row[i] = quads[i / 4][i % 4];
  return row;
#endif
}

// Those of four views, from `first` on, four times each; those of four texels, for each view.
inline Wide of_views(const Vec4& v, [[maybe_unused]] std::size_t first) {
#ifdef __AVX512F__
  using Int16 = std::int32_t __attribute__((vector_size(64)));
  constexpr Int16 view{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
  return (Wide)_mm512_maskz_permutexvar_ps(0xFFFF, (__m512i)view,
                                           _mm512_castps128_ps512((__m128)v));
#else
  return joined(Vec4{} + v[first], Vec4{} + v[first + 1]);
#endif
}
inline Wide of_texels(const Vec4& v) {
#ifdef __AVX512F__
  return (Wide)_mm512_maskz_broadcast_f32x4(0xFFFF, (__m128)v);
#else
  return joined(v, v);
#endif
}

// Sum of the fours.
inline Vec4 sum_of_quads(Wide a) {
#ifdef __AVX512F__
  const Vec8 b = low_half(a) + high_half(a);
#else
  const Vec8 b = a;
#endif
  return __builtin_shufflevector(b, b, 0, 1, 2, 3) + __builtin_shufflevector(b, b, 4, 5, 6, 7);
}

// Four numbers of each of the fields; those of four texels side by side, view by view.
struct Quad {
  Wide x, y, z, w;
};

inline Quad quad_of(const Rows& rows) {
  const std::array<Wide, 4> numbers = transposed(rows);
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

#ifdef __AVX512F__
// Two quads that follow each other. Halfs are transposed before they become floats: half the
// registers, and one load brings both quads (3 % less time a query by itself, 5 % in a batch, than
// quads that are floats one by one).
// @param place  (view, texel) to where the first one's numbers begin.
template <typename Place>
[[gnu::always_inline]] inline std::array<Quad, 2> two_quads_of(const Place& place) {
  const auto both = [&](std::size_t v, std::size_t t) {  // of two views
    const auto eight = [](const half* p) {
      __m128i numbers;
      std::memcpy(&numbers, p, sizeof numbers);
      return numbers;
    };
    return _mm256_inserti128_si256(_mm256_castsi128_si256(eight(place(v, t))),
                                   eight(place(v + 2, t)), 1);
  };
  // Of each view, number by number: the four texels' a, then their b.
  struct Numbers {
    __m256i a_b, c_d;
  };
  const auto numbers = [](__m256i even, __m256i odd) {
    return Numbers{_mm256_unpacklo_epi32(even, odd), _mm256_unpackhi_epi32(even, odd)};
  };
  std::array<std::array<Numbers, 2>, 2> of_quad;  // [quad][views 0 and 2, 1 and 3]
  for (std::size_t v = 0; v < 2; ++v) {
    const __m256i t0 = both(v, 0);
    const __m256i t1 = both(v, 1);
    const __m256i t2 = both(v, 2);
    const __m256i t3 = both(v, 3);
    of_quad[0][v] = numbers(_mm256_unpacklo_epi16(t0, t1), _mm256_unpacklo_epi16(t2, t3));
    of_quad[1][v] = numbers(_mm256_unpackhi_epi16(t0, t1), _mm256_unpackhi_epi16(t2, t3));
  }
  const auto floats = [](__m256i halfs) { return (Wide)_mm512_maskz_cvtph_ps(0xFFFF, halfs); };
  const auto quad = [&](const std::array<Numbers, 2>& n) {
    return Quad{floats(_mm256_unpacklo_epi64(n[0].a_b, n[1].a_b)),
                floats(_mm256_unpackhi_epi64(n[0].a_b, n[1].a_b)),
                floats(_mm256_unpacklo_epi64(n[0].c_d, n[1].c_d)),
                floats(_mm256_unpackhi_epi64(n[0].c_d, n[1].c_d))};
  };
  return {quad(of_quad[0]), quad(of_quad[1])};
}
#endif

// Equation 1, |w| max(<w, l> / |w|, 0)^n = <w, l> ((<w, l> / |w|)^2)^((n - 1) / 2) where <w, l> is
// positive, summed up. A NaN stays one.
template <std::size_t Count>
[[gnu::always_inline]] inline Wide sum_of(const std::array<Quad, Count>& lobes,
                                          const Direction& light) {
  std::array<Wide, Count> product;
  std::array<Wide, Count> square_cosine;
  std::array<Wide, Count> exponent;
  for (std::size_t k = 0; k < Count; ++k) {
    const Quad& q = lobes[k];
    product[k] = q.x * light.x + q.y * light.y + q.z * light.z;
    square_cosine[k] = product[k] * product[k] / (q.x * q.x + q.y * q.y + q.z * q.z);
    exponent[k] = 0.5F * q.w - 0.5F;
  }
  const std::array<Wide, Count> power =
      branchless_powers<WideInt, WideUnsigned>(square_cosine, exponent);
  const auto lobe = [&](std::size_t k) {
    return product[k] <= 0.0F ? Wide{} : product[k] * power[k];
  };
  Wide sum = lobe(0);
  for (std::size_t k = 1; k < Count; ++k) sum += lobe(k);
  return sum;
}

}  // namespace

// The fields that a query asks for, view + texel, and their weights.
template <typename Number>
struct FieldRepresentation::Fields {
  using Value = Number;
  std::array<const Number*, 4> view;
  std::array<std::size_t, 4> texel;
  Vec4 view_weight;
  Vec4 texel_weight;

  [[gnu::always_inline]] Rows quad(std::size_t first_view, std::size_t k) const {
    Rows rows;
    for (std::size_t t = 0; t < 4; ++t) {
      std::array<const Number*, views_at_once> quads;
      for (std::size_t v = 0; v < views_at_once; ++v)
        quads[v] = view[first_view + v] + texel[t] + 4 * k;
      rows[t] = row_of(quads);
    }
    return rows;
  }
};

FieldRepresentation::FieldRepresentation(Model model)
    : model_(std::move(model)), view_stencil_(model_.head.views) {
  const std::size_t n_views = model_.head.views.size();
  const std::size_t n = model_.head.texels() * model_.floats_a_field();
  // A view is often a multiple of 4 kB: one texel's fields of all views would lie in one set of the
  // cache. A line between views spreads them: 4 % less time a query. Floats stay where the model
  // has them.
  constexpr std::size_t line = 64 / sizeof(half);
  if (model_.storage == Storage::half) halfs_.resize(n_views * (n + line));
  for (std::size_t view = 0; view < n_views; ++view) {
    const float* fields = &model_.fields[view * n];
    if (halfs_.empty()) {
      float_views_.push_back(fields);
    } else {
      half_views_.push_back(&halfs_[view * (n + line)]);
      std::copy_n(fields, n, &halfs_[view * (n + line)]);
    }
  }
}

template <typename Number>
[[gnu::always_inline]] inline FieldRepresentation::Fields<Number> FieldRepresentation::fields(
    const std::vector<const Number*>& of_view, const TexelStencil& texels,
    const StencilLane& views) const {
  const std::size_t stride = model_.floats_a_field();
  Fields<Number> fields;
  for (std::size_t i = 0; i < 4; ++i) {
    fields.view[i] = of_view[static_cast<std::size_t>(views.index[i])];
    fields.texel[i] = texels.index[i] * stride;
  }
  // One by one, as they were written: read together, they would have to wait for memory.
  const auto& v = views.weight;
  const auto& t = texels.weight;
  fields.view_weight = Vec4{v[0], v[1], v[2], v[3]};
  fields.texel_weight = Vec4{t[0], t[1], t[2], t[3]};
  return fields;
}

// Each of RGB a polynomial, all views and texels of a row at once. A function of its own, so that
// the others keep their fields in registers.
template <typename Number>
[[gnu::noinline]] Vec4 FieldRepresentation::polynomials_of_rgb(
    const std::vector<const Number*>& of_view, const TexelStencil& texels, const StencilLane& views,
    const Direction& light) const {
  const Fields<Number> fields = this->fields(of_view, texels, views);
  const float x = light.x;
  const float y = light.y;
  const std::array<float, 6> basis{x * x, y * y, x * y, x, y, 1};
  Wide sum{};
  for (std::size_t first = 0; first < 4; first += views_at_once) {
    Rows value{};
    for (std::size_t k = 0; k < basis.size(); ++k) {
      const Rows quad = fields.quad(first, k);
      for (std::size_t t = 0; t < 4; ++t) value[t] += quad[t] * basis[k];
    }
    const Wide weight = of_views(fields.view_weight, first);
    for (std::size_t t = 0; t < 4; ++t)
      sum += at_least_zero(value[t]) * (weight * fields.texel_weight[t]);
  }
  return sum_of_quads(sum);
}

// The sums of lobes of the fields. How many is known when it is compiled, so that they are computed
// side by side.
template <std::size_t Lobes, typename Fields>
[[gnu::always_inline]] inline Wide sum_of_lobes(const Fields& fields, std::size_t first,
                                                const Direction& light) {
  std::array<Quad, Lobes> lobes;
  std::size_t k = 0;
#ifdef __AVX512F__
  if constexpr (std::is_same_v<typename Fields::Value, half>) {
    for (; k + 1 < Lobes; k += 2) {
      const std::array<Quad, 2> two = two_quads_of(
          [&](std::size_t v, std::size_t t) { return fields.view[v] + fields.texel[t] + 4 * k; });
      lobes[k] = two[0];
      lobes[k + 1] = two[1];
    }
  }
#endif
  for (; k < Lobes; ++k) lobes[k] = quad_of(fields.quad(first, k));
  return sum_of(lobes, light);
}

template <typename Fields>
[[gnu::always_inline]] inline Wide sum_of_lobes(std::size_t lobes, const Fields& fields,
                                                std::size_t first, const Direction& light) {
  if (lobes == 2) return sum_of_lobes<2>(fields, first, light);
  if (lobes == 1) return sum_of_lobes<1>(fields, first, light);
  return lobes == 3 ? sum_of_lobes<3>(fields, first, light) : sum_of_lobes<4>(fields, first, light);
}

// Lobes, or a polynomial, times a colour.
template <typename Number>
[[gnu::always_inline]] inline Vec4 FieldRepresentation::luminances(const Fields<Number>& fields,
                                                                   const Direction& light) const {
  const float x = light.x;
  const float y = light.y;
  Wide sum{};
  for (std::size_t first = 0; first < 4; first += views_at_once) {
    Wide value{};
    if (model_.kind == Kind::lobes) {
      value = sum_of_lobes(model_.lobes, fields, first, light);
    } else {
      const Quad a = quad_of(fields.quad(first, 0));
      const Quad b = quad_of(fields.quad(first, 1));
      value =
          at_least_zero(a.x * (x * x) + a.y * (y * y) + a.z * (x * y) + a.w * x + b.x * y + b.y);
    }
    value *= of_views(fields.view_weight, first) * of_texels(fields.texel_weight);
    const Rows colour = fields.quad(first, model_.quads() - 1);
    // In pairs: half the chain of sums that wait for each other.
    const Wide some = (colour[0] * of_each_quad<0>(value) + colour[1] * of_each_quad<1>(value)) +
                      (colour[2] * of_each_quad<2>(value) + colour[3] * of_each_quad<3>(value));
    sum = first == 0 ? some : sum + some;
  }
  return sum_of_quads(sum);
}

template <typename Number>
[[gnu::always_inline]] inline Rgb FieldRepresentation::decode(
    const std::vector<const Number*>& of_view, const TexelStencil& texels, const StencilLane& views,
    const Direction& light) const {
  const Vec4 rgb = is_rgb(model_.kind) ? polynomials_of_rgb(of_view, texels, views, light)
                                       : luminances(fields(of_view, texels, views), light);
  return Rgb(rgb[0], rgb[1], rgb[2]) *
         (has_cosine(model_.kind) ? model_.scale * light.z : model_.scale);
}

Rgb FieldRepresentation::evaluate(Texcoord uv, Direction light, Direction view,
                                  float /*lod*/) const {
  if (!(light.z > 0) || !(view.z > 0)) return {0, 0, 0};
  // The views first: what is loaded waits for these longest.
  const StencilLane views = view_stencil_.locate(model_.head.views, view);
  const TexelStencil texels = bilinear_texels(uv, model_.head.width, model_.head.height);
  return halfs_.empty() ? decode(float_views_, texels, views, light)
                        : decode(half_views_, texels, views, light);
}

void FieldRepresentation::evaluate(std::span<const AppearanceQuery> queries,
                                   std::span<Rgb> answers) const {
  decode_in_batches(queries, answers, [this](const QueryBatch& batch) {
    return halfs_.empty() ? decode(float_views_, batch) : decode(half_views_, batch);
  });
}

template <typename Number>
Batch<Rgb> FieldRepresentation::decode(const std::vector<const Number*>& of_view,
                                       const QueryBatch& batch) const {
  const TexelBatch texels = texel_batch(batch, model_.head.width, model_.head.height);
  const StencilBatch views = view_stencil_.locate(model_.head.views, batch.view);
  Batch<Rgb> values;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const Direction light(batch.light.x[i], batch.light.y[i], batch.light.z[i]);
    values[i] = decode(of_view, texels.lane(i), views[i], light);
  }
  return values;
}

std::size_t FieldRepresentation::constant_bytes() const {
  std::size_t bytes = 0;
  for (const GlTexture& table : view_stencil_.glsl(model_.head.views, "btf_any").textures)
    bytes += table.bytes.size();
  return bytes;
}

void FieldRepresentation::save(const std::filesystem::path& folder) const {
  write_model(folder, model_);
}

}  // namespace weft::reflectance_fields
