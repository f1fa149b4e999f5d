// Codec zero: a raw BTF with its mip chain, interpolated over texels, directions and levels.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "btf/appearance.h"
#include "btf/btf.h"

namespace weft {

/// Interpolates f = B / cos(theta_light), divided at the samples, barycentrically over lights and
/// views, and multiplies by the query's own cosine, so that a Lambert surface is exact everywhere.
class RawAppearance : public Appearance {
 public:
  /// Builds the mip chain by area mean (odd and 1-wide sizes too) down to 1 x 1.
  explicit RawAppearance(std::shared_ptr<const Btf> btf);

  using Appearance::evaluate;
  Rgb evaluate(Texcoord uv, Direction light, Direction view, float lod) const override;
  bool has_lod() const override { return true; }
  Imath::V2i texels() const override { return {levels_[0]->width(), levels_[0]->height()}; }

  /// Level 0 is the finest.
  const std::vector<std::shared_ptr<const Btf>>& levels() const { return levels_; }

 private:
  std::vector<std::shared_ptr<const Btf>> levels_;
  std::vector<float> inverse_cosines_;
};

/// 1 / cos(theta) of each light; 0 for one on the horizon, which tells nothing about f.
std::vector<float> inverse_cosines(const HemisphereSampling& lights);

/// The two texels around a place along one axis of n texels, in texels from the first one's centre,
/// and the share of the second; repeats. For a NaN they are in range and the share is NaN.
struct AxisStencil {
  std::uint32_t low;
  std::uint32_t high;
  float blend;
};
/// @param place  in [-0.5, n - 0.5], or a NaN.
inline AxisStencil axis_stencil(float place, int n) {
  const float below = std::floor(place);
  // In [-1, n - 1]; of a NaN, which may not be cast, -1. Without a branch that no CPU foresees.
  const int k = static_cast<int>(std::max(-1.0F, below));
  return {static_cast<std::uint32_t>(k < 0 ? n - 1 : k),
          static_cast<std::uint32_t>(k + 1 >= n ? 0 : k + 1), place - below};
}
inline AxisStencil column_stencil(Texcoord uv, int width) {
  return axis_stencil((uv.x - std::floor(uv.x)) * static_cast<float>(width) - 0.5F, width);
}
inline AxisStencil row_stencil(Texcoord uv, int height) {
  return axis_stencil((1 - (uv.y - std::floor(uv.y))) * static_cast<float>(height) - 0.5F, height);
}

/// The four texels around (u, v) and their bilinear weights; repeats. `index` = y * width + x. For
/// a NaN the indices are in range and the weights NaN.
struct TexelStencil {
  std::array<std::uint32_t, 4> index;
  std::array<float, 4> weight;
};
inline TexelStencil bilinear_texels(Texcoord uv, int width, int height) {
  const AxisStencil x = column_stencil(uv, width);
  const AxisStencil y = row_stencil(uv, height);
  const std::uint32_t low = y.low * static_cast<std::uint32_t>(width);
  const std::uint32_t high = y.high * static_cast<std::uint32_t>(width);
  return {{low + x.low, low + x.high, high + x.low, high + x.high},
          {(1 - x.blend) * (1 - y.blend), x.blend * (1 - y.blend), (1 - x.blend) * y.blend,
           x.blend * y.blend}};
}

/// Which samples of a texel's ABRDF a query blends: index = view n_lights + light, and its weight.
/// View v and light l of three each are at 4 v + l; places 4 v + 3 are not used, or weigh nothing.
struct SampleStencil {
  std::array<std::int32_t, 12> index;
  std::array<float, 12> weight;
};
/// @param of_light  what the weights of each light are multiplied by.
/// @param factor    what all of them are multiplied by.
SampleStencil sample_stencil(const Stencil& views, const Stencil& lights,
                             std::span<const float> of_light, float factor);

/// The sum of a level's samples at all those texels.
Rgb blended(const Btf& level, const TexelStencil& texels, const SampleStencil& samples);

/// Half as wide and high (rounded down, at least 1, as OpenGL's mip levels): each coarse texel is
/// the area mean of the fine texels that it covers, fractions of texels included.
Btf next_mip_level(const Btf& finer);

}  // namespace weft
