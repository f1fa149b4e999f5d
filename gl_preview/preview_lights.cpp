// Environments cut into directional lights.

#include "gl_preview/preview_lights.h"

#include <algorithm>

namespace weft {

namespace {

/// Pixels x0 <= x < x1, y0 <= y < y1.
struct Region {
  int x0, y0, x1, y1;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

/// The environment as power: radiance times solid angle of each pixel.
class PowerMap {
 public:
  explicit PowerMap(const EnvironmentLight& environment) : environment_(environment) {}

  int width() const { return environment_.radiance.width; }
  int height() const { return environment_.radiance.height; }

  /// Solid angle of a pixel of row y in sr.
  double solid_angle(int y) const {
    const double step = std::numbers::pi / height();
    return (std::cos(y * step) - std::cos((y + 1) * step)) * 2 * std::numbers::pi / width();
  }

  Direction direction(int x, int y) const {
    const double theta = std::numbers::pi * (y + 0.5) / height();
    const double phi =
        std::numbers::pi - 2 * std::numbers::pi * (x + 0.5) / width() + environment_.rotate;
    return from_spherical(theta, phi);
  }

  double power(int x, int y) const {
    return static_cast<double>(mean(environment_.radiance.rgb(x, y))) * solid_angle(y);
  }

  double power(const Region& r) const {
    double sum = 0;
    for (int y = r.y0; y < r.y1; ++y) {
      for (int x = r.x0; x < r.x1; ++x) sum += power(x, y);
    }
    return sum;
  }

  /// All light of a region from the mean of its directions, weighted by power. It carries the
  /// region's vector irradiance, so that every surface that sees the whole region gets what the
  /// region itself would give.
  DirectionalLight light(const Region& r) const {
    Imath::V3d towards(0);
    Imath::V3d irradiance(0);
    double total = 0;
    for (int y = r.y0; y < r.y1; ++y) {
      for (int x = r.x0; x < r.x1; ++x) {
        towards += Imath::V3d(direction(x, y)) * power(x, y);
        total += power(x, y);
        const Rgb radiance = environment_.radiance.rgb(x, y);
        irradiance += Imath::V3d(radiance.x, radiance.y, radiance.z) * solid_angle(y);
      }
    }
    irradiance *= towards.length() / total;
    return {Vec3(towards.normalized()), Rgb(Vec3(irradiance))};
  }

  /// Cuts the longer side (as seen on the sphere) where both halves have the same power, nearest
  /// pixel.
  std::pair<Region, Region> cut(const Region& r) const {
    const double middle = std::numbers::pi * (r.y0 + r.y1) / 2 / height();
    const double seen_width = 2.0 * r.width() / width() * std::sin(middle);
    const bool across =
        r.height() < 2 || (r.width() > 1 && seen_width > 1.0 * r.height() / height());
    const int begin = across ? r.x0 : r.y0;
    const int end = across ? r.x1 : r.y1;
    const auto first = [&](int at) {
      return across ? Region{r.x0, r.y0, at, r.y1} : Region{r.x0, r.y0, r.x1, at};
    };
    const double half = power(r) / 2;
    double sum = 0;
    int at = begin + 1;
    for (; at < end; ++at) {
      const Region line = across ? Region{at - 1, r.y0, at, r.y1} : Region{r.x0, at - 1, r.x1, at};
      const double next = sum + power(line);
      if (next >= half) {
        if (half - sum < next - half) --at;
        break;
      }
      sum = next;
    }
    at = std::clamp(at, begin + 1, end - 1);
    return {first(at), across ? Region{at, r.y0, r.x1, r.y1} : Region{r.x0, at, r.x1, r.y1}};
  }

 private:
  const EnvironmentLight& environment_;
};

}  // namespace

std::vector<DirectionalLight> median_cut(const EnvironmentLight& environment, int most_lights) {
  const PowerMap map(environment);
  std::vector<Region> regions = {{0, 0, map.width(), map.height()}};
  while (regions.size() * 2 <= static_cast<std::size_t>(most_lights)) {
    std::vector<Region> finer;
    for (const Region& region : regions) {
      if (region.width() * region.height() < 2) {
        finer.push_back(region);
        continue;
      }
      const auto [a, b] = map.cut(region);
      finer.push_back(a);
      finer.push_back(b);
    }
    if (finer.size() == regions.size()) break;
    regions = std::move(finer);
  }
  std::vector<DirectionalLight> lights;
  for (const Region& region : regions) {
    if (map.power(region) > 0) lights.push_back(map.light(region));
  }
  return lights;
}

PreviewLights preview_lights(const Scene& scene) {
  PreviewLights lights{scene.point_lights, scene.directional_lights};
  for (const EnvironmentLight& environment : scene.environments) {
    const auto cut = median_cut(environment, lights_per_environment);
    lights.directionals.insert(lights.directionals.end(), cut.begin(), cut.end());
  }
  return lights;
}

}  // namespace weft
