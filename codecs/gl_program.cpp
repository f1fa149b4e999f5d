// Sizes and kinds of the texture formats of a GlProgram.

#include "codecs/gl_program.h"

#include <algorithm>

namespace weft {

std::size_t bytes_per_texel(GlTexture::Format format) {
  using F = GlTexture::Format;
  switch (format) {
    case F::r8:
    case F::r8ui:
      return 1;
    case F::rg8:
    case F::rg8ui:
    case F::r16ui:
    case F::r16f:
      return 2;
    case F::rgb8:
    case F::rgb8ui:
      return 3;
    case F::rgba8:
    case F::rgba8ui:
    case F::r32ui:
    case F::r32f:
      return 4;
    case F::rgb16f:
      return 6;
    case F::rgba16ui:
    case F::rgba16f:
    case F::rg32f:
      return 8;
    case F::rgb32f:
      return 12;
    case F::rgba32f:
      return 16;
  }
  return 0;  // every format is named above
}

int level_side(int side, int level) {
  return std::max(side >> level, 1);
}

std::size_t texel_count(const GlTexture& texture) {
  std::size_t count = 0;
  for (int level = 0; level < texture.levels; ++level) {
    count += static_cast<std::size_t>(level_side(texture.width, level)) *
             level_side(texture.height, level) * texture.layers;
  }
  return count;
}

bool is_integer(GlTexture::Format format) {
  using F = GlTexture::Format;
  switch (format) {
    case F::r8ui:
    case F::rg8ui:
    case F::rgb8ui:
    case F::rgba8ui:
    case F::r16ui:
    case F::rgba16ui:
    case F::r32ui:
      return true;
    default:
      return false;
  }
}

}  // namespace weft
