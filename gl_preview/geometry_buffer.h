// What each pixel of a scene sees (a G-buffer), and the picture that is shaded from it.
#pragma once

#include "gl_preview/gl_object.h"

namespace weft {

/// Three RGBA, 32-bit float textures: (world position, lod), (normal, u), (tangent, v); a stencil
/// that says which appearance is seen, 0 for none; and the picture. Row 0 is the top where drawn to
/// with GL_UPPER_LEFT.
class GeometryBuffer {
 public:
  static constexpr int texture_count = 3;
  /// Appearances that the stencil can tell apart.
  static constexpr int most_appearances = 255;

  GeometryBuffer() = default;
  /// @throws Error failed, naming the size that is too large.
  GeometryBuffer(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  GLuint picture() const { return picture_.name(); }
  GLuint picture_framebuffer() const { return picture_framebuffer_.name(); }

  /// Clears all, and draws to the three textures, depth and stencil from here on.
  void begin_geometry() const;
  /// Draws to the picture, under the same stencil, from here on.
  void begin_shading() const;
  /// The three textures, to `first_unit` and the next two.
  void bind_textures(GLuint first_unit) const;

 private:
  int width_ = 0;
  int height_ = 0;
  GlTextureName<GL_TEXTURE_2D> textures_[texture_count];
  GlTextureName<GL_TEXTURE_2D> depth_stencil_;
  GlTextureName<GL_TEXTURE_2D> picture_;
  GlFramebuffer geometry_framebuffer_;
  GlFramebuffer picture_framebuffer_;
};

}  // namespace weft
