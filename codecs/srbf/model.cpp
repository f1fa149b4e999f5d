#include "codecs/srbf/model.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace weft::srbf {

namespace {

// A texel's numbers where the layout has them.
void lay_out(const Layout& layout, const Kernels& kernels, double colour_scale, float* row) {
  const Shape& shape = layout.shape;
  for (std::size_t j = 0; j < shape.kernels; ++j) {
    const double* p = kernels.centre(j, 0);
    for (std::size_t s = 0; s < 3 * shape.modes; ++s)
      row[layout.place(j, s)] = static_cast<float>(p[s]);
    for (std::size_t c = 0; c < 3; ++c) {
      row[layout.place(j, 3 * shape.modes + c)] =
          static_cast<float>(kernels.colours()[3 * j + c] * colour_scale);
    }
  }
  for (std::size_t k = 0; k < shape.modes; ++k)
    row[layout.angle_place(k)] = static_cast<float>(kernels.angles()[k]);
}

// Of a texel, counted over all levels.
std::string place_of(const MipSizes& sizes, std::size_t texel) {
  int level = 0;
  while (level + 1 < sizes.levels() && texel >= sizes.first_texel(level + 1)) ++level;
  const std::size_t at = texel - sizes.first_texel(level);
  const auto width = static_cast<std::size_t>(sizes.width_of(level));
  return fmt::format("mip level {}, texel ({}, {})", level, at % width, at / width);
}

}  // namespace

std::string name_of(Filtering filtering) {
  return filtering == Filtering::numbers ? "numbers" : "values";
}

void Model::set_kernels(const std::vector<Kernels>& kernels, double colour_scale) {
  values.assign(kernels.size() * row(), 0);
  scale.assign(row(), 0);
  tbb::parallel_for(std::size_t{0}, kernels.size(), [&](std::size_t texel) {
    lay_out(layout(), kernels[texel], colour_scale, &values[texel * row()]);
  });
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) throw beyond_float(place_of(sizes(), i / row()));
    float& largest = scale[i % row()];
    largest = std::max(largest, std::abs(values[i]));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float largest = scale[i % row()];
    values[i] = largest > 0 ? stored_value(storage, values[i] / largest) : 0;
  }
}

}  // namespace weft::srbf
