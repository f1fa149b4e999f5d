// Uploading textures within the GPU's limits, and declaring their samplers.

#include "gl_preview/gpu_appearance.h"

#include <fmt/core.h>

#include "btf/error.h"
#include "codecs/representation.h"
#include "gl_preview/geometry_buffer.h"
#include "gl_preview/gl_context.h"
#include "gl_preview/tabulated_material.h"

namespace weft {

namespace {

/// How GL names a format: of the storage, of the components and their type.
struct GlFormat {
  GLenum internal;
  GLenum components;
  GLenum type;
};

GlFormat gl_format(GlTexture::Format format) {
  using Format = GlTexture::Format;
  switch (format) {
    case Format::r8:
      return {GL_R8, GL_RED, GL_UNSIGNED_BYTE};
    case Format::rg8:
      return {GL_RG8, GL_RG, GL_UNSIGNED_BYTE};
    case Format::rgb8:
      return {GL_RGB8, GL_RGB, GL_UNSIGNED_BYTE};
    case Format::rgba8:
      return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
    case Format::r8ui:
      return {GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE};
    case Format::rg8ui:
      return {GL_RG8UI, GL_RG_INTEGER, GL_UNSIGNED_BYTE};
    case Format::rgb8ui:
      return {GL_RGB8UI, GL_RGB_INTEGER, GL_UNSIGNED_BYTE};
    case Format::rgba8ui:
      return {GL_RGBA8UI, GL_RGBA_INTEGER, GL_UNSIGNED_BYTE};
    case Format::r16ui:
      return {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT};
    case Format::rgba16ui:
      return {GL_RGBA16UI, GL_RGBA_INTEGER, GL_UNSIGNED_SHORT};
    case Format::r32ui:
      return {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT};
    case Format::r16f:
      return {GL_R16F, GL_RED, GL_HALF_FLOAT};
    case Format::rgba16f:
      return {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT};
    case Format::rgb16f:
      return {GL_RGB16F, GL_RGB, GL_HALF_FLOAT};
    case Format::r32f:
      return {GL_R32F, GL_RED, GL_FLOAT};
    case Format::rg32f:
      return {GL_RG32F, GL_RG, GL_FLOAT};
    case Format::rgb32f:
      return {GL_RGB32F, GL_RGB, GL_FLOAT};
    case Format::rgba32f:
      return {GL_RGBA32F, GL_RGBA, GL_FLOAT};
  }
  throw failed("texture", "unknown format");
}

GLint limit(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

void refuse_above(int found, GLenum limit_name, const std::string& doing, const char* what) {
  if (const GLint most = limit(limit_name); found > most) {
    throw failed(doing, fmt::format("{} {}, and this GPU takes at most {}", found, what, most),
                 "use fewer texels or directions, or a compressed dataset");
  }
}

void check_size(const GlTexture& t, const std::string& doing) {
  if (t.width < 1 || t.height < 1 || t.layers < 1) {
    throw failed(doing, fmt::format("has a size of {} x {} x {}", t.width, t.height, t.layers));
  }
  if (const std::size_t expected = texel_count(t) * bytes_per_texel(t.format);
      t.bytes.size() != expected) {
    throw failed(doing,
                 fmt::format("has {} bytes where {} were expected", t.bytes.size(), expected));
  }
  switch (t.kind) {
    case GlTexture::Kind::buffer:
      refuse_above(t.width, GL_MAX_TEXTURE_BUFFER_SIZE, doing, "texels in a texture buffer");
      return;
    case GlTexture::Kind::array_2d:
      refuse_above(t.layers, GL_MAX_ARRAY_TEXTURE_LAYERS, doing, "layers");
      [[fallthrough]];
    case GlTexture::Kind::image_2d:
      refuse_above(t.width, GL_MAX_TEXTURE_SIZE, doing, "texels a row");
      refuse_above(t.height, GL_MAX_TEXTURE_SIZE, doing, "rows");
  }
}

/// Only texelFetch reads them: without this, integer and one-level textures would count as
/// incomplete.
void set_nearest(GLuint texture) {
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void set_trilinear(GLuint texture) {
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_REPEAT);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_REPEAT);
}

void upload_levels(GLuint texture, const GlTexture& t, const GlFormat& format) {
  const std::byte* bytes = t.bytes.data();
  for (int level = 0; level < t.levels; ++level) {
    const int width = level_side(t.width, level);
    const int height = level_side(t.height, level);
    glTextureSubImage3D(texture, level, 0, 0, 0, width, height, t.layers, format.components,
                        format.type, bytes);
    bytes += bytes_per_texel(t.format) * width * height * t.layers;
  }
}

std::string sampler_declaration(const GlTexture& texture, std::size_t unit) {
  const char* kind = "samplerBuffer";
  if (texture.kind == GlTexture::Kind::image_2d) kind = "sampler2D";
  if (texture.kind == GlTexture::Kind::array_2d) kind = "sampler2DArray";
  return fmt::format("layout(binding = {}) uniform highp {}{} {};\n", unit,
                     is_integer(texture.format) ? "u" : "", kind, texture.name);
}

}  // namespace

GlProgram gl_program_of(const Appearance& appearance, const std::string& name) {
  if (const auto* representation = dynamic_cast<const Representation*>(&appearance)) {
    return representation->gl_program();
  }
  if (appearance.texels() == Imath::V2i(1, 1)) return tabulated_program(appearance);
  throw bad_input("material " + name, "has no program for the GPU", "render it with `weft render`");
}

GpuAppearance::Texture GpuAppearance::upload(const GlTexture& t, const std::string& doing) {
  check_size(t, doing);
  const GlFormat format = gl_format(t.format);
  Texture result;
  switch (t.kind) {
    case GlTexture::Kind::buffer:
      if (format.components == GL_RGB && format.internal != GL_RGB32F) {
        throw failed(doing, "a texture buffer has no three-component format but rgb32f");
      }
      result.storage = GlBuffer::make();
      glNamedBufferStorage(result.storage.name(), static_cast<GLsizeiptr>(t.bytes.size()),
                           t.bytes.data(), 0);
      check_gl(doing);
      result.buffer_texture = GlTextureName<GL_TEXTURE_BUFFER>::make();
      glTextureBuffer(result.buffer_texture.name(), format.internal, result.storage.name());
      break;
    case GlTexture::Kind::image_2d:
      result.image = GlTextureName<GL_TEXTURE_2D>::make();
      glTextureStorage2D(result.image.name(), 1, format.internal, t.width, t.height);
      check_gl(doing);
      glTextureSubImage2D(result.image.name(), 0, 0, 0, t.width, t.height, format.components,
                          format.type, t.bytes.data());
      set_nearest(result.image.name());
      break;
    case GlTexture::Kind::array_2d:
      result.array = GlTextureName<GL_TEXTURE_2D_ARRAY>::make();
      glTextureStorage3D(result.array.name(), t.levels, format.internal, t.width, t.height,
                         t.layers);
      check_gl(doing);
      upload_levels(result.array.name(), t, format);
      if (t.levels > 1)
        set_trilinear(result.array.name());
      else
        set_nearest(result.array.name());
      break;
  }
  check_gl(doing);
  return result;
}

GpuAppearance::GpuAppearance(const GlProgram& program, const std::string& name) {
  const int units = static_cast<int>(program.textures.size()) + GeometryBuffer::texture_count;
  refuse_above(units, GL_MAX_TEXTURE_IMAGE_UNITS, name, "textures in one program");
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  for (const GlTexture& texture : program.textures) {
    source_ += sampler_declaration(texture, textures_.size());
    const std::string doing = fmt::format("{}: texture {} ({:.1f} MB)", name, texture.name,
                                          static_cast<double>(texture.bytes.size()) * 1e-6);
    textures_.push_back(upload(texture, doing));
    bytes_ += texture.bytes.size();
  }
  source_ += program.glsl;
}

void GpuAppearance::bind() const {
  for (std::size_t unit = 0; unit < textures_.size(); ++unit) {
    glBindTextureUnit(static_cast<GLuint>(unit), textures_[unit].name());
  }
}

}  // namespace weft
