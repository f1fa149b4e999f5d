// The ABRDFs that maps are fitted to: the texels of a BTF and of its mip levels, counted through.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "btf/btf.h"
#include "codecs/factor_maps/lanes.h"
#include "codecs/factor_maps/model.h"

namespace weft::factor_maps {

class TexelSource {
 public:
  /// @param with_levels  false: level 0 alone. Otherwise the mip chain is made, a third of the data
  ///                     more, where the data's own memory has room.
  TexelSource(std::shared_ptr<const Btf> btf, bool with_levels);

  const Btf& finest() const { return *btfs_[0]; }
  const std::vector<Level>& levels() const { return levels_; }
  std::size_t size() const;

  /// As `Btf::abrdf`, of a texel of any level: [view][light][rgb].
  void abrdf(std::size_t texel, std::span<float> values) const;

  /// f = B / cos(theta_light) of up to 16 texels, [light][view]. A light on the horizon, where B
  /// tells nothing of f, is given that of the nearest one above it.
  /// @throws Error  naming view, light and texel of a value that is not finite and >= 0.
  LaneVector block(std::span<const std::size_t> texels) const;

 private:
  std::vector<std::shared_ptr<const Btf>> btfs_;  // one a level
  std::vector<Level> levels_;
  std::vector<float> inverse_cosine_;
  std::vector<std::size_t> light_of_;  // itself, or the one that stands for it
};

}  // namespace weft::factor_maps
