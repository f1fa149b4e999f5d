// A raw bidirectional texture function: B(texel, light, view) for every pair of two samplings.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "btf/large_array.h"

namespace weft {

/// What a stored number is.
enum class PixelType { half, float32 };

/// W x H texels x views x lights of RGB, in half or float. Row 0 is the top (v near 1).
///
/// Values lie ABRDF by ABRDF: [y][x][view][light][rgb], so that the few neighbours that an
/// interpolation asks for are close to each other. They are in memory, or in a scratch file where a
/// budget is exceeded: whoever reads them all then does so texel by texel.
class Btf {
 public:
  /// All values zero.
  /// @param memory  what they may take; without it as much as there is.
  /// @throws Error  for a size of zero, or where there is no room for the scratch file.
  Btf(int width, int height, HemisphereSampling views, HemisphereSampling lights, PixelType type,
      std::shared_ptr<MemoryBudget> memory = nullptr);

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

  /// How many views next to each other memory allows to hold beside the data, at least 1.
  std::size_t views_at_once() const;
  /// `count` views from `first` on as a BTF of their own, all values zero.
  Btf blank_views(std::size_t first, std::size_t count) const;
  /// The same with their values; one pass over the data.
  Btf some_views(std::size_t first, std::size_t count) const;
  /// The reverse of `some_views`.
  void set_views(std::size_t first, const Btf& part);

  /// Values of one texel in floats: [view][light][rgb], views x lights x 3 of them.
  void abrdf(int x, int y, std::span<float> values) const;

  /// Size of the raw values in bytes.
  std::size_t bytes() const {
    return halfs_.size() * sizeof(half) + floats_.size() * sizeof(float);
  }

  /// Whether the values lie in a scratch file.
  bool mapped() const { return halfs_.mapped() || floats_.mapped(); }
  /// What arrays that are made of the data and grow with them may take; may be null: all there is.
  const std::shared_ptr<MemoryBudget>& memory() const { return memory_; }

  /// Width of one tile in world units, and where the data came from (canonical JSON text).
  float tile_size = 1;
  std::string provenance = "{}";

  /// The stored values, one of the two is empty; for decoders and uploads.
  std::span<const half> halfs() const { return halfs_.values(); }
  std::span<const float> floats() const { return floats_.values(); }

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
  std::shared_ptr<MemoryBudget> memory_;
  LargeArray<half> halfs_;
  LargeArray<float> floats_;
};

/// Calls `use(first, part)` with all views in turn, those from `first` on as a BTF of their own: as
/// many at a time as memory allows, so that each walk over a scratch file serves many of them. Data
/// in memory are one part.
void for_some_views(const Btf& btf,
                    const std::function<void(std::size_t first, const Btf& part)>& use);

/// @param values  one view's, [light][y][x][rgb].
/// @throws Error  naming a sample, where a value is NaN, infinite or negative, or overflows a half
/// (count and the worst sample).
void check_storable(std::size_t view, std::span<const float> values, int width, int height,
                    PixelType type);

}  // namespace weft
