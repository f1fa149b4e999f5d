#include "tracer/lights/environment_radiance.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "btf/error.h"

namespace weft {

std::int64_t clear_negative_values(Image& radiance) {
  std::int64_t count = 0;
  for (float& value : radiance.values) {
    if (value >= 0 || !std::isfinite(value)) continue;
    value = 0;
    ++count;
  }
  return count;
}

void check_radiance(const EnvironmentLight& light) {
  const Image& image = light.radiance;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Rgb c = image.rgb(x, y);
      // The mean is what the pixel is drawn by: channels that overflow it are too large as well.
      if (std::isfinite(mean(c)) && std::min({c.x, c.y, c.z}) >= 0) continue;
      throw bad_input(light.name,
                      fmt::format("pixel x = {}, y = {} is ({}, {}, {}), expected finite radiance "
                                  "of at least 0",
                                  x, y, c.x, c.y, c.z));
    }
  }
}

}  // namespace weft
