#include "codecs/srbf/mip_levels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weft::srbf {

namespace {

constexpr double lobes = 3;  // the paper's a

// Equation 3.12.
double lanczos(double x) {
  if (std::abs(x) >= lobes) return 0;
  if (std::abs(x) < 1e-9) return 1;
  const double t = std::numbers::pi * x;
  return lobes * std::sin(t) * std::sin(t / lobes) / (t * t);
}

}  // namespace

int MipSizes::levels() const {
  int count = 1;
  while (std::max(width, height) >> count > 0) ++count;
  return count;
}

std::size_t MipSizes::first_texel(int level) const {
  std::size_t count = 0;
  for (int k = 0; k < level; ++k) count += texels(k);
  return count;
}

std::size_t MipSizes::parent(int level, std::size_t texel) const {
  const auto w = static_cast<std::size_t>(width_of(level));
  const int x = std::min(static_cast<int>(texel % w) / 2, width_of(level + 1) - 1);
  const int y = std::min(static_cast<int>(texel / w) / 2, height_of(level + 1) - 1);
  return static_cast<std::size_t>(y) * width_of(level + 1) + x;
}

std::vector<AxisTap> lanczos_taps(int coarse_texel, int coarse_size, int fine_size) {
  const double step = static_cast<double>(fine_size) / coarse_size;
  const double centre = (coarse_texel + 0.5) * step;  // in fine texels
  std::vector<AxisTap> taps;
  double sum = 0;
  for (int i = static_cast<int>(std::floor(centre - lobes * step)); i < centre + lobes * step;
       ++i) {
    const double weight = lanczos((i + 0.5 - centre) / step);
    if (weight == 0) continue;
    taps.push_back({(i % fine_size + fine_size) % fine_size, weight});
    sum += weight;
  }
  for (AxisTap& tap : taps) tap.weight /= sum;
  return taps;
}

MipLevels::MipLevels(const Btf& btf)
    : btf_(btf),
      sizes_{btf.width(), btf.height()},
      values_(3 * btf.views().size() * btf.lights().size()) {
  levels_.resize(1);
  for (int level = 1; level < sizes_.levels(); ++level) levels_.push_back(next_level(level));
}

void MipLevels::abrdf(int level, std::size_t texel, std::span<float> values) const {
  if (level == 0) {
    const auto width = static_cast<std::size_t>(btf_.width());
    return btf_.abrdf(static_cast<int>(texel % width), static_cast<int>(texel / width), values);
  }
  std::copy_n(&levels_[level][texel * values_], values_, values.begin());
}

LargeArray<float> MipLevels::next_level(int level) const {
  const int width = sizes_.width_of(level);
  const int fine_width = sizes_.width_of(level - 1);
  LargeArray<float> coarse(sizes_.texels(level) * values_, btf_.memory());
  tbb::parallel_for(std::size_t{0}, sizes_.texels(level), [&](std::size_t texel) {
    std::vector<float> read(values_);
    float* sum = &coarse[texel * values_];
    for (const AxisTap& row : lanczos_taps(static_cast<int>(texel) / width, sizes_.height_of(level),
                                           sizes_.height_of(level - 1))) {
      for (const AxisTap& column :
           lanczos_taps(static_cast<int>(texel) % width, width, fine_width)) {
        abrdf(level - 1, static_cast<std::size_t>(row.texel) * fine_width + column.texel, read);
        const auto weight = static_cast<float>(row.weight * column.weight);
        for (std::size_t i = 0; i < values_; ++i) sum[i] += weight * read[i];
      }
    }
  });
  return coarse;
}

}  // namespace weft::srbf
