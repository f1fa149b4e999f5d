// The sums of a block's texels under every light, and what they tell: means and their variances.
//
// Samples come in waves, whose sums are floats, laid out for sixteen lights at a time; a finished
// wave is folded into doubles. Each wave is a few groups of samples, and the spread of the groups'
// sums tells the variance.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tracer/lanes.h"

namespace weft {

class TexelSums {
 public:
  static constexpr std::uint32_t most_groups = 4;  ///< of samples, in a wave

  static std::size_t bytes_for(std::size_t texels, std::size_t lights);

  TexelSums(std::size_t most_texels, std::size_t lights);

  /// Forgets all. @param group_size  samples of a texel in a group.
  void clear(std::size_t texels, std::uint32_t group_size);
  /// Samples of a texel in a whole wave.
  std::uint32_t wave_size() const { return group_size_ * most_groups; }

  /// Which sums of the wave sample `sample` of the wave adds to.
  std::uint32_t slot(std::uint32_t texel, std::uint32_t sample) const {
    return texel * most_groups + sample / group_size_;
  }
  /// Of a slot.
  static std::uint32_t texel_of(std::uint32_t slot) { return slot / most_groups; }
  /// Three, R, G and B, for each group of sixteen lights from `group` on.
  FloatLanes* wave(std::uint32_t slot, std::size_t group) {
    return &wave_[(slot * light_groups_ + group) * 3];
  }
  /// Ends a wave in which each of `texels` got `samples` samples.
  void fold(std::span<const std::uint32_t> texels, std::uint32_t samples);

  std::uint32_t samples(std::size_t texel) const { return samples_[texel]; }
  /// Mean over the samples of a texel, for a light and a channel.
  double mean(std::size_t texel, std::size_t light, int channel) const {
    return sums_[place(texel, light, channel)] / samples_[texel];
  }
  /// Variance of that mean, from the spread of groups of samples; conservative, as stratification
  /// between groups is not credited. Needs two groups.
  double variance(std::size_t texel, std::size_t light, int channel) const;
  /// The same of the mean of RGB.
  double grey_variance(std::size_t texel, std::size_t light) const;

 private:
  std::size_t place(std::size_t texel, std::size_t light, int channel) const {
    return ((texel * light_groups_ + light / lanes) * 3 + static_cast<std::size_t>(channel)) *
               lanes +
           light % lanes;
  }
  double variance_of(std::size_t texel, double squares, double sum) const;

  std::size_t light_groups_;            // of sixteen
  std::uint32_t group_size_ = 1;        // samples
  std::vector<std::uint32_t> samples_;  // of each texel, so far
  std::vector<std::uint32_t> groups_;   // the same in groups of samples
  std::vector<FloatLanes> wave_;        // [slot][light group][channel]
  std::vector<double> sums_;            // [texel][light group][channel][lane]
  std::vector<double> squares_;         // of the sample groups' sums, over their samples
  std::vector<double> grey_squares_;    // [texel][light group][lane], of the mean of RGB
};

}  // namespace weft
