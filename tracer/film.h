// The picture while it grows: sums and sums of squares of each pixel's samples, in double.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "images/image.h"

namespace weft {

/// Where a sample lies about its pixel. Samples are drawn from the filter, so each counts for its
/// own pixel only, and pixels stay independent of each other.
enum class PixelFilter {
  box,       ///< evenly over the pixel
  centre,    ///< at its centre
  gaussian,  ///< standard deviation half a pixel, cut at 1.5 pixels
};

/// Offset from the pixel's top left corner for two random numbers in [0, 1).
std::array<double, 2> filter_offset(PixelFilter filter, float u0, float u1);

class Film {
 public:
  Film(int width, int height);

  /// Threads may add to different pixels at once. A sample that is NaN or infinite is left out and
  /// counted; one with a negative channel is used as it is, and counted.
  void add(int x, int y, const Rgb& sample);

  /// Mean of each pixel's samples; 0 where it has none.
  Image image() const;
  /// Variance of each pixel's mean, a channel each: the samples' own over their number. 0 below two
  /// samples.
  Image variance() const;

  struct Invalid {
    std::int64_t not_finite = 0;
    std::int64_t negative = 0;
    std::optional<std::array<int, 2>>
        first;  ///< x, y of the first pixel, row by row, that had one that is not finite
  };
  Invalid invalid() const;

 private:
  struct Pixel {
    std::array<double, 3> sum{};
    std::array<double, 3> sum_of_squares{};
    std::int32_t samples = 0;
    std::int32_t not_finite = 0;
    std::int32_t negative = 0;
  };
  int width_;
  int height_;
  std::vector<Pixel> pixels_;
};

}  // namespace weft
