#include "codecs/sample_check.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "btf/error.h"

namespace weft {

namespace {

bool is_reflectance(float value) {
  return value >= 0 && std::isfinite(value);
}

// Index of the texel's first bad value, or the number of values.
std::size_t first_invalid(const std::vector<float>& values) {
  return static_cast<std::size_t>(std::ranges::find_if_not(values, is_reflectance) -
                                  values.begin());
}

}  // namespace

void refuse_invalid_samples(const Btf& btf) {
  const std::size_t n_lights = btf.lights().size();
  const std::size_t count = 3 * n_lights * btf.views().size();
  std::vector<std::size_t> invalid(static_cast<std::size_t>(btf.width()) * btf.height());
  std::vector<float> found(invalid.size());
  tbb::parallel_for(0, btf.width() * btf.height(), [&](int texel) {
    std::vector<float> values(count);
    btf.abrdf(texel % btf.width(), texel / btf.width(), values);
    invalid[texel] = first_invalid(values);
    if (invalid[texel] < count) found[texel] = values[invalid[texel]];
  });
  for (std::size_t texel = 0; texel < invalid.size(); ++texel) {
    if (invalid[texel] == count) continue;
    const std::size_t pair = invalid[texel] / 3;
    const auto width = static_cast<std::size_t>(btf.width());
    throw bad_input("BTF", fmt::format("view {}, light {}, texel ({}, {}): {} is not a finite "
                                       "number >= 0",
                                       pair / n_lights, pair % n_lights, texel % width,
                                       texel / width, found[texel]));
  }
}

}  // namespace weft
