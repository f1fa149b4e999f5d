// GLSL twins of the stencils that every decoder needs: four texels around (u, v), and the
// neighbours of a direction.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "codecs/gl_program.h"

namespace weft {

/// Defines `struct btf_TexelStencil { ivec2 texel[4]; float weight[4]; }` and
/// `btf_TexelStencil btf_bilinear_texels(vec2 uv, ivec2 size)`: the twin of `bilinear_texels`.
std::string texel_stencil_glsl();

/// Defines `struct btf_Stencil { ivec3 index; vec3 weight; }`, which `hemisphere_sampling_glsl`
/// returns.
std::string direction_stencil_glsl();

/// The twin of HemisphereSampling::locate: `btf_Stencil PREFIX_locate(vec3 direction)`, reading the
/// tables that are appended as texture buffers PREFIX_points, PREFIX_triangles, PREFIX_grid and
/// PREFIX_hull.
/// @param prefix  starts with `btf_`, e.g. `btf_lights`.
GlProgram hemisphere_sampling_glsl(const HemisphereSampling& sampling, const std::string& prefix);

/// A texture buffer of `values` as they lie in memory.
template <typename Values>
GlTexture buffer_texture(std::string name, GlTexture::Format format, const Values& values) {
  GlTexture texture{std::move(name), GlTexture::Kind::buffer, format, 0, 1, 1, {}};
  const auto bytes = std::as_bytes(std::span(values));
  texture.bytes.assign(bytes.begin(), bytes.end());
  texture.width = static_cast<int>(texture.bytes.size() / bytes_per_texel(format));
  return texture;
}

}  // namespace weft
