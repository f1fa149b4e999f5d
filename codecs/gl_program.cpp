// Sizes and kinds of the texture formats of a GlProgram.

#include "codecs/gl_program.h"

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
