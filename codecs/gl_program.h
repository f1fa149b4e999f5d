// What a representation gives to the GPU: textures as bytes and a piece of GLSL. Plain data, no GL.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace weft {

/// One texture. `buffer` is a texture buffer (samplerBuffer, texelFetch by index) of `width`
/// texels; `image_2d` and `array_2d` are fetched with texelFetch too, row 0 first in `bytes`, no
/// padding. An `array_2d` of several `levels` (each half as wide and high, rounded down, at least
/// 1; all layers of one level after those of the one before) is filtered trilinearly by the GPU
/// and repeats: `textureLod`.
struct GlTexture {
  enum class Kind { buffer, image_2d, array_2d };
  enum class Format {
    r8,
    rg8,
    rgb8,
    rgba8,  // unsigned normalised: sampler*
    r8ui,
    rg8ui,
    rgb8ui,
    rgba8ui,  // usampler*
    r16ui,
    rgba16ui,
    r32ui,  // usampler*
    r16f,
    rgba16f,
    rgb16f,
    r32f,
    rg32f,
    rgb32f,
    rgba32f
  };  // a buffer cannot have an rgb format but rgb32f

  std::string name;  ///< of the uniform sampler, declared by the harness: unique within a program
  Kind kind = Kind::buffer;
  Format format = Format::r32f;
  int width = 0;
  int height = 1;
  int layers = 1;
  std::vector<std::byte> bytes;
  int levels = 1;
};

std::size_t bytes_per_texel(GlTexture::Format format);
/// Width or height of a level.
int level_side(int side, int level);
/// Of all layers of all levels: `bytes` holds as many.
std::size_t texel_count(const GlTexture& texture);
bool is_integer(GlTexture::Format format);

/// `glsl` defines `vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod)` in GLSL 4.50. It
/// may use the samplers named by `textures` (declared before it by the harness) and must not
/// declare uniforms of its own. Every other global name starts with `btf_`. Constants are written
/// into the text.
struct GlProgram {
  std::vector<GlTexture> textures;
  std::string glsl;
};

}  // namespace weft
