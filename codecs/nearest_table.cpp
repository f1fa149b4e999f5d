#include "codecs/nearest_table.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "codecs/stencil_glsl.h"

namespace weft {

// Eight cells or more between neighbours, so that each direction has some of its own.
NearestTable::NearestTable(const HemisphereSampling& sampling)
    : size_(std::max(256, static_cast<int>(16 * std::sqrt(static_cast<double>(sampling.size()))))),
      table_(static_cast<std::size_t>(size_) * size_) {
  tbb::parallel_for(0, size_, [&](int y) {
    for (int x = 0; x < size_; ++x) {
      Vec2 p(2 * (static_cast<float>(x) + 0.5F) / static_cast<float>(size_) - 1,
             2 * (static_cast<float>(y) + 0.5F) / static_cast<float>(size_) - 1);
      if (p.length() > 1) p /= p.length();  // the corners are beyond the horizon
      table_[static_cast<std::size_t>(y) * size_ + x] = sampling.nearest(from_parabolic(p));
    }
  });
  for (std::size_t i = 0; i < sampling.size(); ++i) {
    const float scale = 1 / (1 + sampling[i].z);  // as it will be asked for
    table_[static_cast<std::size_t>(place(sampling[i].y * scale)) * size_ +
           place(sampling[i].x * scale)] = static_cast<std::uint16_t>(i);
  }
}

GlProgram NearestTable::glsl(const std::string& prefix) const {
  GlProgram program;
  program.textures.push_back(
      buffer_texture(prefix + "_nearest_table", GlTexture::Format::r16ui, table_));
  program.glsl = fmt::format(
      "int {0}_nearest(vec3 direction) {{\n"
      "  vec2 p = direction.xy / (1.0 + direction.z);\n"
      "  ivec2 cell = clamp(ivec2((p + 1.0) * (float({1}) / 2.0)), ivec2(0), ivec2({1} - 1));\n"
      "  return int(texelFetch({0}_nearest_table, cell.y * {1} + cell.x).r);\n"
      "}}\n",
      prefix, size_);
  return program;
}

}  // namespace weft
