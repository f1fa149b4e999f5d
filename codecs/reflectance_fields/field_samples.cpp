#include "codecs/reflectance_fields/field_samples.h"

#include <algorithm>

#include "codecs/luminance.h"

namespace weft::reflectance_fields {

std::vector<std::size_t> lights_above_horizon(const HemisphereSampling& lights) {
  std::vector<std::size_t> above;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (lights[i].z > 0) above.push_back(i);
  }
  return above;
}

void read_field(const Btf& btf, std::size_t view, std::size_t texel,
                const std::vector<std::size_t>& lights, FieldSamples& samples) {
  const auto width = static_cast<std::size_t>(btf.width());
  const auto x = static_cast<int>(texel % width);
  const auto y = static_cast<int>(texel / width);
  samples.luminance.resize(lights.size());
  samples.largest = 0;
  samples.colour = {};
  double sum = 0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const Rgb value = btf.at(lights[i], view, x, y);
    double luminance = 0;
    for (int c = 0; c < 3; ++c) {
      luminance += luminance_of_rgb[c] * value[c];
      samples.colour[c] += value[c];
    }
    samples.luminance[i] = luminance;
    samples.largest = std::max(samples.largest, luminance);
    sum += luminance;
  }
  if (!(sum > 0)) return;
  for (double& luminance : samples.luminance) luminance /= samples.largest;
  for (double& c : samples.colour) c *= samples.largest / sum;
}

}  // namespace weft::reflectance_fields
