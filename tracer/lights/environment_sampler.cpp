#include "tracer/lights/environment_sampler.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "tracer/lights/environment_radiance.h"

namespace weft {
namespace {

constexpr double pi = std::numbers::pi;

struct Choice {
  int index;
  double remainder;  ///< where in the chosen interval, in [0, 1)
};

/// The interval of `edges` (ascending from 0) that holds u times the last edge.
Choice choose(std::span<const double> edges, double u) {
  const double target = u * edges.back();
  // upper_bound never chooses an empty interval: the edge after it is larger than the target.
  const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, target);
  const auto index = static_cast<int>(above - edges.begin()) - 1;
  const double width = edges[index + 1] - edges[index];
  const double remainder = width > 0 ? (target - edges[index]) / width : 0;
  return {index, std::clamp(remainder, 0.0, 1.0)};
}

}  // namespace

EnvironmentSampler::EnvironmentSampler(const EnvironmentLight& light) : light_(light) {
  check_radiance(light);  // a scene that a program made was read by nobody
  const Image& image = light.radiance;
  row_edges_.push_back(0);
  for (int y = 0; y < image.height; ++y) {
    double sum = 0;
    pixel_edges_.push_back(0);
    for (int x = 0; x < image.width; ++x) {
      sum += mean(image.rgb(x, y));
      pixel_edges_.push_back(sum);
    }
    row_edges_.push_back(row_edges_.back() + sum * solid_angle(y));
  }
}

double EnvironmentSampler::solid_angle(int row) const {
  const Image& image = light_.radiance;
  const double top = std::cos(pi * row / image.height);
  const double bottom = std::cos(pi * (row + 1) / image.height);
  return 2 * pi / image.width * (top - bottom);
}

EnvironmentSampler::PixelIndex EnvironmentSampler::pixel_of(const Direction& d) const {
  const Image& image = light_.radiance;
  const double theta = std::atan2(std::hypot(d.x, d.y), d.z);
  const double phi = std::atan2(d.y, d.x) - light_.rotate;
  const double column = (pi - phi) / (2 * pi);
  const double turn = column - std::floor(column);
  return {std::min(static_cast<int>(turn * image.width), image.width - 1),
          std::clamp(static_cast<int>(theta / pi * image.height), 0, image.height - 1)};
}

float EnvironmentSampler::pixel_pdf(PixelIndex pixel) const {
  const double total = row_edges_.back();
  return total > 0 ? static_cast<float>(mean(light_.radiance.rgb(pixel.x, pixel.y)) / total) : 0.0F;
}

EnvironmentSampler::Sample EnvironmentSampler::sample(float u0, float u1) const {
  const Image& image = light_.radiance;
  if (row_edges_.back() == 0) return {{0, 0, 1}, {0, 0, 0}, 0};
  const Choice row = choose(row_edges_, u0);
  const std::size_t stride = image.width + 1;
  const Choice column = choose({&pixel_edges_[row.index * stride], stride}, u1);

  const double top = std::cos(pi * row.index / image.height);
  const double bottom = std::cos(pi * (row.index + 1) / image.height);
  const double z = top + (bottom - top) * row.remainder;
  const double phi = pi - 2 * pi * (column.index + column.remainder) / image.width + light_.rotate;
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  const Direction direction(static_cast<float>(r * std::cos(phi)),
                            static_cast<float>(r * std::sin(phi)), static_cast<float>(z));
  const PixelIndex pixel{column.index, row.index};
  return {direction, image.rgb(pixel.x, pixel.y), pixel_pdf(pixel)};
}

Rgb EnvironmentSampler::radiance(const Direction& direction) const {
  const PixelIndex pixel = pixel_of(direction);
  return light_.radiance.rgb(pixel.x, pixel.y);
}

float EnvironmentSampler::pdf(const Direction& direction) const {
  return pixel_pdf(pixel_of(direction));
}

}  // namespace weft
