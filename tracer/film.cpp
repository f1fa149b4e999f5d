#include "tracer/film.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weft {

std::array<double, 2> filter_offset(PixelFilter filter, float u0, float u1) {
  switch (filter) {
    case PixelFilter::centre:
      return {0.5, 0.5};
    case PixelFilter::gaussian: {
      // Radius of a two-dimensional normal distribution, cut at 1.5 pixels = three standard
      // deviations.
      constexpr double sigma = 0.5, within = 1 - 0.011108996538242306;  // 1 - exp(-9 / 2)
      const double radius = sigma * std::sqrt(-2 * std::log(1 - within * u0));
      const double angle = 2 * std::numbers::pi * u1;
      return {0.5 + radius * std::cos(angle), 0.5 + radius * std::sin(angle)};
    }
    case PixelFilter::box:
      break;
  }
  return {u0, u1};
}

Film::Film(int width, int height)
    : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * height) {}

void Film::add(int x, int y, const Rgb& sample) {
  Pixel& pixel = pixels_[static_cast<std::size_t>(y) * width_ + x];
  if (!(std::isfinite(sample.x) && std::isfinite(sample.y) && std::isfinite(sample.z))) {
    ++pixel.not_finite;
    return;
  }
  if (std::min({sample.x, sample.y, sample.z}) < 0) ++pixel.negative;
  ++pixel.samples;
  for (int c = 0; c < 3; ++c) {
    const double value = sample[c];
    pixel.sum[c] += value;
    pixel.sum_of_squares[c] += value * value;
  }
}

Image Film::image() const {
  Image image(width_, height_);
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const Pixel& pixel = pixels_[i];
    if (pixel.samples == 0) continue;
    for (int c = 0; c < 3; ++c) {
      image.values[3 * i + c] = static_cast<float>(pixel.sum[c] / pixel.samples);
    }
  }
  return image;
}

Image Film::variance() const {
  Image image(width_, height_);
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const Pixel& pixel = pixels_[i];
    if (pixel.samples < 2) continue;
    const double n = pixel.samples;
    for (int c = 0; c < 3; ++c) {
      const double squares = pixel.sum_of_squares[c] - pixel.sum[c] * pixel.sum[c] / n;
      image.values[3 * i + c] = static_cast<float>(std::max(0.0, squares) / ((n - 1) * n));
    }
  }
  return image;
}

Film::Invalid Film::invalid() const {
  Invalid invalid;
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const Pixel& pixel = pixels_[i];
    invalid.not_finite += pixel.not_finite;
    invalid.negative += pixel.negative;
    if (pixel.not_finite > 0 && !invalid.first) {
      invalid.first = {static_cast<int>(i % width_), static_cast<int>(i / width_)};
    }
  }
  return invalid;
}

}  // namespace weft
