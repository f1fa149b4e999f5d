#include "acquisition/sample_points.h"

#include <numeric>

#include "tracer/sobol.h"

namespace weft {

namespace {

FloatLanes unit_floats(const WordLanes& words) {
  const WordLanes top = words >> 8;  // no sign is left
  return __builtin_convertvector(reinterpret_cast<const IntLanes&>(top), FloatLanes) *
         (1.0F / 16777216.0F);
}

}  // namespace

void SamplePoints::draw(std::uint64_t key, std::uint32_t first, std::uint32_t count) {
  constexpr WordLanes ramp{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  count_ = count;
  for (std::uint32_t i = 0; i < count; i += lanes) {
    const auto [x, y] = sobol_words(ramp + (first + i), key);
    x_[i / lanes] = unit_floats(x);
    y_[i / lanes] = unit_floats(y);
  }
}

std::span<const std::uint8_t> SamplePoints::along_curve() {
  constexpr std::uint32_t side = 8;
  constexpr std::array<std::uint8_t, side> spread{0, 1, 4, 5, 16, 17, 20, 21};
  std::array<std::uint8_t, most> square{};
  std::array<std::uint8_t, side * side + 1> starts{};
  for (std::uint32_t i = 0; i < count_; ++i) {
    const auto [x, y] = (*this)[i];
    square[i] = static_cast<std::uint8_t>(spread[static_cast<std::size_t>(x * side)] +
                                          2 * spread[static_cast<std::size_t>(y * side)]);
    ++starts[square[i] + 1U];
  }
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  for (std::uint32_t i = 0; i < count_; ++i)
    order_[starts[square[i]]++] = static_cast<std::uint8_t>(i);
  return {order_.data(), count_};
}

}  // namespace weft
