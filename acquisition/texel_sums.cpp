#include "acquisition/texel_sums.h"

#include <algorithm>

namespace weft {

namespace {

std::size_t groups_of(std::size_t lights) {
  return (lights + lanes - 1) / lanes;
}

}  // namespace

std::size_t TexelSums::bytes_for(std::size_t texels, std::size_t lights) {
  // Per value: a wave's sums and the double ones in three channels, and the grey ones.
  return texels * groups_of(lights) * lanes *
         (3 * (most_groups * sizeof(float) + 2 * sizeof(double)) + sizeof(double));
}

TexelSums::TexelSums(std::size_t most_texels, std::size_t lights)
    : light_groups_(groups_of(lights)),
      wave_(most_texels * light_groups_ * 3 * most_groups),
      sums_(most_texels * light_groups_ * 3 * lanes),
      squares_(sums_.size()),
      grey_squares_(sums_.size() / 3) {}

void TexelSums::clear(std::size_t texels, std::uint32_t group_size) {
  group_size_ = group_size;
  samples_.assign(texels, 0);
  groups_.assign(texels, 0);
  std::ranges::fill(sums_, 0.0);
  std::ranges::fill(squares_, 0.0);
  std::ranges::fill(grey_squares_, 0.0);
}

void TexelSums::fold(std::span<const std::uint32_t> texels, std::uint32_t samples) {
  const std::uint32_t groups = (samples + group_size_ - 1) / group_size_;
  for (const std::uint32_t texel : texels) {
    samples_[texel] += samples;
    groups_[texel] += groups;
    for (std::uint32_t s = 0; s < groups; ++s) {
      const double inverse = 1.0 / std::min(group_size_, samples - s * group_size_);
      for (std::size_t g = 0; g < light_groups_; ++g) {
        FloatLanes* wave = this->wave(texel * most_groups + s, g);
        const std::size_t first = (texel * light_groups_ + g) * lanes;
        double* sums = &sums_[3 * first];
        double* squares = &squares_[3 * first];
        double* grey_squares = &grey_squares_[first];
        for (std::size_t k = 0; k < lanes; ++k) {
          double grey = 0;
          for (std::size_t c = 0; c < 3; ++c) {
            const double value = wave[c][k];
            sums[c * lanes + k] += value;
            squares[c * lanes + k] += value * value * inverse;
            grey += value / 3;
          }
          grey_squares[k] += grey * grey * inverse;
        }
        std::fill_n(wave, 3, FloatLanes{});
      }
    }
  }
}

// From sum over groups of S^2 / n, S a group's sum of n samples, and the sum of all N samples.
double TexelSums::variance_of(std::size_t texel, double squares, double sum) const {
  const double n = samples_[texel];
  return std::max(0.0, squares - sum * sum / n) / (groups_[texel] - 1.0) / n;
}

double TexelSums::variance(std::size_t texel, std::size_t light, int channel) const {
  const std::size_t i = place(texel, light, channel);
  return variance_of(texel, squares_[i], sums_[i]);
}

double TexelSums::grey_variance(std::size_t texel, std::size_t light) const {
  const double mean =
      (this->mean(texel, light, 0) + this->mean(texel, light, 1) + this->mean(texel, light, 2)) / 3;
  return variance_of(texel, grey_squares_[texel * light_groups_ * lanes + light],
                     mean * samples_[texel]);
}

}  // namespace weft
