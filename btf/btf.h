// A raw bidirectional texture function in memory: B(texel, light, view) for every pair of two
// samplings.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "btf/hemisphere_sampling.h"

namespace weft {

/// What a stored number is.
enum class PixelType { half, float32 };

/// W x H texels x views x lights of RGB, in half or float. Row 0 is the top (v near 1).
///
/// Values lie ABRDF by ABRDF: [y][x][view][light][rgb], so that the few neighbours that an
/// interpolation asks for are close to each other.
class Btf {
 public:
  /// All values zero. @throws Error for a size of zero.
  Btf(int width, int height, HemisphereSampling views, HemisphereSampling lights, PixelType type);

  int width() const { return width_; }
  int height() const { return height_; }
  const HemisphereSampling& views() const { return views_; }
  const HemisphereSampling& lights() const { return lights_; }
  PixelType pixel_type() const { return type_; }

  /// B of one sample in 1/sr.
  Rgb at(std::size_t light, std::size_t view, int x, int y) const;
  void set(std::size_t light, std::size_t view, int x, int y, const Rgb& value);

  /// All values of one view, [light][y][x][rgb], lights x height x width x 3 of them. Views may be
  /// set side by side. @throws Error  for another count, or as `check_storable`.
  void set_view(std::size_t view, std::span<const float> values);
  std::vector<float> view_values(std::size_t view) const;

  /// Values of one texel in floats: [view][light][rgb], views x lights x 3 of them.
  void abrdf(int x, int y, std::span<float> values) const;

  /// Size of the raw values in bytes.
  std::size_t bytes() const {
    return halfs_.size() * sizeof(half) + floats_.size() * sizeof(float);
  }

  /// Width of one tile in world units, and where the data came from (canonical JSON text).
  float tile_size = 1;
  std::string provenance = "{}";

  /// The stored values, one of the two is empty; for decoders and uploads.
  std::span<const half> halfs() const { return halfs_; }
  std::span<const float> floats() const { return floats_; }

 private:
  std::size_t offset(std::size_t light, std::size_t view, int x, int y) const {
    return 3 *
           (((static_cast<std::size_t>(y) * width_ + x) * views_.size() + view) * lights_.size() +
            light);
  }

  int width_;
  int height_;
  HemisphereSampling views_;
  HemisphereSampling lights_;
  PixelType type_;
  std::vector<half> halfs_;
  std::vector<float> floats_;
};

/// @param values  one view's, [light][y][x][rgb].
/// @throws Error  naming a sample, where a value is NaN, infinite or negative, or overflows a half
/// (count and the worst sample).
void check_storable(std::size_t view, std::span<const float> values, int width, int height,
                    PixelType type);

}  // namespace weft
