#include "btf/btf.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "btf/error.h"

namespace weft {

namespace {

constexpr float largest_half = 65504.0F;

// One sample that may not be stored, for the message.
std::string sample_name(std::size_t index, std::size_t view, int width, int height) {
  const std::size_t texel = index / 3;
  const auto row = static_cast<std::size_t>(width);
  const std::size_t texels = row * height;
  return fmt::format("view {}, light {}, texel ({}, {})", view, texel / texels,
                     texel % texels % row, texel % texels / row);
}

}  // namespace

Btf::Btf(int width, int height, HemisphereSampling views, HemisphereSampling lights, PixelType type,
         std::shared_ptr<MemoryBudget> memory)
    : width_(width),
      height_(height),
      views_(std::move(views)),
      lights_(std::move(lights)),
      type_(type),
      memory_(std::move(memory)) {
  if (width < 1 || height < 1) {
    throw bad_input("texels", fmt::format("{} x {}; expected at least 1 x 1", width, height));
  }
  const std::size_t count =
      3 * static_cast<std::size_t>(width) * height * views_.size() * lights_.size();
  if (type == PixelType::half)
    halfs_ = LargeArray<half>(count, memory_);
  else
    floats_ = LargeArray<float>(count, memory_);
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

void Btf::set_view(std::size_t view, std::span<const float> values) {
  const std::size_t count = 3 * static_cast<std::size_t>(width_) * height_ * lights_.size();
  if (values.size() != count) {
    throw bad_input(fmt::format("view {}", view),
                    fmt::format("has {} values; expected {}", values.size(), count));
  }
  check_storable(view, values, width_, height_, type_);
  std::size_t i = 0;
  for (std::size_t l = 0; l < lights_.size(); ++l) {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x, i += 3) {
        set(l, view, x, y, Rgb(values[i], values[i + 1], values[i + 2]));
      }
    }
  }
}

std::vector<float> Btf::view_values(std::size_t view) const {
  std::vector<float> values;
  values.reserve(3 * static_cast<std::size_t>(width_) * height_ * lights_.size());
  for (std::size_t l = 0; l < lights_.size(); ++l) {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const Rgb value = at(l, view, x, y);
        values.insert(values.end(), {value.x, value.y, value.z});
      }
    }
  }
  return values;
}

void Btf::abrdf(int x, int y, std::span<float> values) const {
  const std::size_t first = offset(0, 0, x, y);
  if (type_ == PixelType::half)
    std::copy_n(halfs_.data() + first, values.size(), values.begin());
  else
    std::copy_n(floats_.data() + first, values.size(), values.begin());
}

std::size_t Btf::views_at_once() const {
  if (!memory_) return views_.size();
  // The other half is for what is made of them.
  const std::size_t fit = memory_->left() / 2 / (bytes() / views_.size());
  return std::clamp<std::size_t>(fit, 1, views_.size());
}

Btf Btf::blank_views(std::size_t first, std::size_t count) const {
  const auto some = views_.directions().subspan(first, count);
  return {width_, height_, HemisphereSampling({some.begin(), some.end()}), lights_, type_, memory_};
}

namespace {

// The views of `part` are those of `whole` from one on; `first` is that one's offset in an ABRDF.
template <typename Part, typename Whole, typename Copy>
void each_texel_of(std::size_t texels, Part part, Whole whole, std::size_t first,
                   const Copy& copy) {
  const std::size_t some = part.size() / texels;
  const std::size_t all = whole.size() / texels;
  tbb::parallel_for(std::size_t{0}, texels, [&](std::size_t texel) {
    copy(part.subspan(texel * some, some), whole.subspan(texel * all + first, some));
  });
}

}  // namespace

Btf Btf::some_views(std::size_t first, std::size_t count) const {
  Btf part = blank_views(first, count);
  const auto copy = [](auto some, auto all) { std::ranges::copy(all, some.begin()); };
  const std::size_t texels = static_cast<std::size_t>(width_) * height_;
  if (type_ == PixelType::half)
    each_texel_of(texels, part.halfs_.values(), halfs(), offset(0, first, 0, 0), copy);
  else
    each_texel_of(texels, part.floats_.values(), floats(), offset(0, first, 0, 0), copy);
  return part;
}

void Btf::set_views(std::size_t first, const Btf& part) {
  const auto copy = [](auto some, auto all) { std::ranges::copy(some, all.begin()); };
  const std::size_t texels = static_cast<std::size_t>(width_) * height_;
  if (type_ == PixelType::half)
    each_texel_of(texels, part.halfs(), halfs_.values(), offset(0, first, 0, 0), copy);
  else
    each_texel_of(texels, part.floats(), floats_.values(), offset(0, first, 0, 0), copy);
}

void for_some_views(const Btf& btf,
                    const std::function<void(std::size_t first, const Btf& part)>& use) {
  if (!btf.mapped()) return use(0, btf);
  std::size_t count = 0;
  for (std::size_t first = 0; first < btf.views().size(); first += count) {
    count = std::min(btf.views_at_once(), btf.views().size() - first);
    use(first, btf.some_views(first, count));
  }
}

void check_storable(std::size_t view, std::span<const float> values, int width, int height,
                    PixelType type) {
  std::size_t invalid = 0;
  std::size_t first_invalid = 0;
  std::size_t overflowing = 0;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] >= 0) || std::isinf(values[i])) {
      if (invalid++ == 0) first_invalid = i;
    } else if (values[i] > largest_half) {
      ++overflowing;
      if (values[i] > values[worst] || overflowing == 1) worst = i;
    }
  }
  if (invalid > 0) {
    throw bad_input(sample_name(first_invalid, view, width, height),
                    fmt::format("is {}, and {} values in all are not finite and >= 0",
                                values[first_invalid], invalid));
  }
  if (overflowing > 0 && type == PixelType::half) {
    throw bad_input(sample_name(worst, view, width, height),
                    fmt::format("is {}, and {} values in all are above {}, the largest half",
                                values[worst], overflowing, largest_half),
                    "store floats: --pixel float");
  }
}

}  // namespace weft
