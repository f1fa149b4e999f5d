// Mip levels of a BTF by Lanczos's filter, a = 3 (paper 001, section 3.3.2, equation 3.12).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "btf/btf.h"
#include "btf/large_array.h"

namespace weft::srbf {

/// Sizes of the levels of a tile, down to 1 x 1; level 0 is the finest.
struct MipSizes {
  int width = 1;
  int height = 1;

  int levels() const;
  int width_of(int level) const { return width >> level > 0 ? width >> level : 1; }
  int height_of(int level) const { return height >> level > 0 ? height >> level : 1; }
  std::size_t texels(int level) const {
    return static_cast<std::size_t>(width_of(level)) * height_of(level);
  }
  /// Texels of the levels before this one; of all for `levels()`.
  std::size_t first_texel(int level) const;
  /// The texel of level + 1 that stands for this one.
  std::size_t parent(int level, std::size_t texel) const;
};

/// Fine texels and their weights, which sum to 1, around one coarse texel of an axis that repeats.
struct AxisTap {
  int texel;
  double weight;
};
std::vector<AxisTap> lanczos_taps(int coarse_texel, int coarse_size, int fine_size);

/// The levels' data. Level 0 stays in the BTF; the rest, a third of it, is kept in floats. Lobes of
/// the filter may leave values below 0.
class MipLevels {
 public:
  /// @param btf  outlives this.
  explicit MipLevels(const Btf& btf);

  const MipSizes& sizes() const { return sizes_; }
  /// [view][light][rgb] of a texel.
  void abrdf(int level, std::size_t texel, std::span<float> values) const;

 private:
  LargeArray<float> next_level(int level) const;

  const Btf& btf_;
  MipSizes sizes_;
  std::size_t values_;                     // of a texel
  std::vector<LargeArray<float>> levels_;  // [level][texel][value]; level 0 empty
};

}  // namespace weft::srbf
