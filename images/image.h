// A picture in memory: rows from the top, channels interleaved, linear floats. No dependency on
// OpenImageIO.
#pragma once

#include <cstddef>
#include <vector>

#include "btf/vector.h"

namespace weft {

struct Image {
  int width = 0;
  int height = 0;
  int channels = 3;
  std::vector<float> values;  ///< [y][x][channel]

  Image() = default;
  Image(int w, int h, int c = 3)
      : width(w), height(h), channels(c), values(static_cast<std::size_t>(w) * h * c, 0.0F) {}

  std::size_t offset(int x, int y) const {
    return (static_cast<std::size_t>(y) * width + x) * channels;
  }
  /// First three channels. Needs channels >= 3.
  Rgb rgb(int x, int y) const {
    const float* p = &values[offset(x, y)];
    return {p[0], p[1], p[2]};
  }
  void set_rgb(int x, int y, const Rgb& c) {
    float* p = &values[offset(x, y)];
    p[0] = c.x;
    p[1] = c.y;
    p[2] = c.z;
  }
};

}  // namespace weft
