#include "btf/btf.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "btf/error.h"

namespace weft {

Btf::Btf(int width, int height, HemisphereSampling views, HemisphereSampling lights, PixelType type)
    : width_(width),
      height_(height),
      views_(std::move(views)),
      lights_(std::move(lights)),
      type_(type) {
  if (width < 1 || height < 1) {
    throw bad_input("texels", fmt::format("{} x {}; expected at least 1 x 1", width, height));
  }
  const std::size_t count =
      3 * static_cast<std::size_t>(width) * height * views_.size() * lights_.size();
  if (type == PixelType::half)
    halfs_.resize(count);
  else
    floats_.resize(count);
}

Rgb Btf::at(std::size_t light, std::size_t view, int x, int y) const {
  const std::size_t i = offset(light, view, x, y);
  if (type_ == PixelType::half) return {halfs_[i], halfs_[i + 1], halfs_[i + 2]};
  return {floats_[i], floats_[i + 1], floats_[i + 2]};
}

void Btf::set(std::size_t light, std::size_t view, int x, int y, const Rgb& value) {
  const std::size_t i = offset(light, view, x, y);
  for (int c = 0; c < 3; ++c) {
    if (type_ == PixelType::half)
      halfs_[i + c] = value[c];
    else
      floats_[i + c] = value[c];
  }
}

void Btf::abrdf(int x, int y, std::span<float> values) const {
  const std::size_t first = offset(0, 0, x, y);
  if (type_ == PixelType::half) {
    std::copy_n(halfs_.begin() + static_cast<std::ptrdiff_t>(first), values.size(), values.begin());
  } else {
    std::copy_n(floats_.begin() + static_cast<std::ptrdiff_t>(first), values.size(),
                values.begin());
  }
}

}  // namespace weft
