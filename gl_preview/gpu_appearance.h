// One appearance on the GPU: its textures uploaded, and the GLSL that decodes them. Knows no codec
// by name.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "btf/appearance.h"
#include "codecs/gl_program.h"
#include "gl_preview/gl_object.h"

namespace weft {

/// What `appearance` gives to the GPU: a representation's own program, or a table of a homogeneous
/// isotropic material. @throws Error bad_input, naming `name`, where it is neither.
GlProgram gl_program_of(const Appearance& appearance, const std::string& name);

class GpuAppearance {
 public:
  /// Uploads the textures into the current context.
  /// @throws Error failed, naming `name` and the texture: beyond a limit of the GPU, out of memory,
  /// or a size that
  ///               is not that of its bytes.
  GpuAppearance(const GlProgram& program, const std::string& name);

  /// The samplers and `vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod)`; goes before a
  /// shader's `main` and after its `#version`.
  const std::string& source() const { return source_; }
  /// Binds the textures to the units that `source()` names: 0, 1, ...
  void bind() const;
  /// Number of its textures.
  std::size_t units() const { return textures_.size(); }
  /// Texture bytes that were uploaded.
  std::size_t bytes() const { return bytes_; }

 private:
  struct Texture {
    GLuint name() const { return buffer_texture.name() + image.name() + array.name(); }
    GlTextureName<GL_TEXTURE_BUFFER> buffer_texture;
    GlTextureName<GL_TEXTURE_2D> image;
    GlTextureName<GL_TEXTURE_2D_ARRAY> array;
    GlBuffer storage;  ///< behind `buffer_texture`
  };
  static Texture upload(const GlTexture& texture, const std::string& doing);

  std::vector<Texture> textures_;
  std::string source_;
  std::size_t bytes_ = 0;
};

}  // namespace weft
