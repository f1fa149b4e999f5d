// Blends of a BTF's samples, written to be inlined into loops over queries.
#pragma once

#ifdef __F16C__
#include <immintrin.h>
#endif

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "btf/raw_appearance.h"

namespace weft {

/// Blends samples of one level, which must outlive it.
template <typename Value>
class SampleBlend {
 public:
  /// @param values  [texel][view][light][rgb].
  /// @param pairs   of views and lights.
  SampleBlend(std::span<const Value> values, std::size_t pairs)
      : values_(values.data()),
        stride_(3 * pairs),
        last_texel_(static_cast<std::uint32_t>(values.size() / stride_ - 1)) {}

  [[gnu::always_inline]] Rgb operator()(const TexelStencil& texels,
                                        const SampleStencil& samples) const {
    // Where the last sample of all may be among them, nothing is read behind it.
    return std::ranges::max(texels.index) == last_texel_ ? blended<true>(texels, samples)
                                                         : blended<false>(texels, samples);
  }

 private:
  using Float4 = float __attribute__((vector_size(16)));

  // Three channels of a sample, and the first of the one behind it.
  static Float4 four_at(const float* p) {
    Float4 values;
    std::memcpy(&values, p, sizeof values);
    return values;
  }
  static Float4 four_at(const half* p) {
#ifdef __F16C__
    std::int64_t values;
    std::memcpy(&values, p, sizeof values);
    return (Float4)_mm_cvtph_ps(_mm_cvtsi64_si128(values));
#else
    return Float4{p[0], p[1], p[2], p[3]};
#endif
  }

  // Texels side by side: a sample's place and weight are loaded once for the four.
  template <bool at_end>
  [[gnu::always_inline]] Rgb blended(const TexelStencil& texels,
                                     const SampleStencil& samples) const {
    std::array<const Value*, 4> texel;
    for (std::size_t t = 0; t < 4; ++t) texel[t] = values_ + texels.index[t] * stride_;
    std::array<Float4, 4> sums{};
    for (std::size_t v = 0; v < 3; ++v) {
      for (std::size_t k = 4 * v; k < 4 * v + 3; ++k) {
        for (std::size_t t = 0; t < 4; ++t) {
          const Value* p = texel[t] + 3 * static_cast<std::ptrdiff_t>(samples.index[k]);
          sums[t] += (at_end ? Float4{p[0], p[1], p[2], 0} : four_at(p)) * samples.weight[k];
        }
      }
    }
    Float4 sum{};
    for (std::size_t t = 0; t < 4; ++t) sum += sums[t] * texels.weight[t];
    return {sum[0], sum[1], sum[2]};
  }

  const Value* values_;
  std::size_t stride_;
  std::uint32_t last_texel_;
};

/// Calls with a level's `SampleBlend`, of halfs or of floats.
template <typename Use>
auto with_sample_blend(const Btf& level, const Use& use) {
  const std::size_t pairs = level.views().size() * level.lights().size();
  return level.pixel_type() == PixelType::half ? use(SampleBlend(level.halfs(), pairs))
                                               : use(SampleBlend(level.floats(), pairs));
}

}  // namespace weft
