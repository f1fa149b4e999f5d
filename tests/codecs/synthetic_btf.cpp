#include "tests/codecs/synthetic_btf.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace weft {

namespace {

float hash_unit(int x, int y, int dimension) {
  auto n = static_cast<std::uint32_t>(x) * 73856093U ^ static_cast<std::uint32_t>(y) * 19349663U ^
           static_cast<std::uint32_t>(dimension) * 83492791U;
  n = (n ^ n >> 15) * 2654435761U;
  return static_cast<float>(n >> 8) / 16777216.0F;
}

Rgb smooth(int x, int y, const Direction& d, int kind) {
  Rgb value;
  for (int c = 0; c < 3; ++c) {
    const float a = hash_unit(x, y, 3 * kind + c) - 0.5F;
    const float b = hash_unit(y, x, 3 * kind + c + 17) - 0.5F;
    value[c] = 1 + a * d.x + b * d.y + 0.5F * (a + b) * d.x * d.y;
  }
  return value;
}

float step(float distance) {
  return 1 / (1 + std::exp(-8 * distance));
}

// Bumps of one period, lit and seen from anywhere.
Rgb bumpy(float u, float v, const Direction& light, const Direction& view) {
  const float a = 2 * std::numbers::pi_v<float> * u;
  const float b = 2 * std::numbers::pi_v<float> * v;
  const float height = std::sin(a) * std::sin(b);
  const Direction normal = Direction(0.5F * std::cos(a), 0.5F * std::cos(b), 1).normalized();
  const Direction half = (light + view).normalized();
  const Rgb albedo = height > 0 ? Rgb(0.8F, 0.35F, 0.45F) : Rgb(0.1F, 0.2F, 0.7F);
  const float lambert = std::max(normal ^ light, 0.0F) / light.z * std::numbers::inv_pi_v<float>;
  const float lobe = (height > 0 ? 1.2F : 0.3F) * std::pow(std::max(normal ^ half, 0.0F), 24.0F);
  const float lit = step(light.z + 0.3F * height + 0.2F * light.x * (0.5F - u) - 0.35F);
  const float seen = step(view.z + 0.3F * height + 0.2F * view.y * (0.5F - v) - 0.25F);
  return (albedo * lambert + Rgb(lobe, lobe, lobe)) * lit * (0.3F + 0.7F * seen);
}

}  // namespace

std::shared_ptr<const Btf> synthetic_btf(int width, int height, const std::string& lights,
                                         const std::string& views, const Formula& formula) {
  Btf btf(width, height, HemisphereSampling(named_directions(views)),
          HemisphereSampling(named_directions(lights)), PixelType::float32);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (std::size_t v = 0; v < btf.views().size(); ++v) {
        for (std::size_t l = 0; l < btf.lights().size(); ++l) {
          const Direction& light = btf.lights()[l];
          btf.set(l, v, x, y, formula(x, y, light, btf.views()[v]) * light.z);
        }
      }
    }
  }
  return std::make_shared<const Btf>(std::move(btf));
}

Rgb light_pattern(int x, int y, const Direction& light) {
  return smooth(x, y, light, 1);
}
Rgb view_pattern(int x, int y, const Direction& view) {
  return smooth(x, y, view, 2);
}

Rgb half_pattern(int x, int y, const Direction& half) {
  const Direction centre =
      Direction(hash_unit(x, y, 50) - 0.5F, hash_unit(x, y, 51) - 0.5F, 2).normalized();
  const float lobe = std::exp(8 * ((centre ^ half) - 1));
  return Rgb(0.2F, 0.25F, 0.3F) + Rgb(1.0F, 0.8F, 0.6F) * lobe;
}

std::shared_ptr<const Btf> realistic_btf(int size, const std::string& directions) {
  const Formula formula = [size](int x, int y, const Direction& light, const Direction& view) {
    return bumpy((static_cast<float>(x) + 0.5F) / static_cast<float>(size),
                 (static_cast<float>(y) + 0.5F) / static_cast<float>(size), light, view);
  };
  return synthetic_btf(size, size, directions, directions, formula);
}

}  // namespace weft
