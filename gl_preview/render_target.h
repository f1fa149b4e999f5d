// A picture on the GPU that can be drawn to.
#pragma once

#include "gl_preview/gl_object.h"

namespace weft {

/// @throws Error failed, where the GPU does not draw so many pixels.
void check_picture_size(int width, int height);

/// A texture of one level that is not filtered. @param format  e.g. GL_RGBA32F.
GlTextureName<GL_TEXTURE_2D> picture_texture(int width, int height, GLenum format);

/// @throws Error failed, where the framebuffer cannot be drawn to.
void check_framebuffer(GLuint framebuffer, int width, int height);

class RenderTarget {
 public:
  RenderTarget() = default;
  RenderTarget(int width, int height, GLenum format);

  int width() const { return width_; }
  int height() const { return height_; }
  GLuint texture() const { return colour_.name(); }
  /// Binds the framebuffer and sets the viewport to all of it.
  void bind() const;

 private:
  int width_ = 0;
  int height_ = 0;
  GlTextureName<GL_TEXTURE_2D> colour_;
  GlFramebuffer framebuffer_;
};

}  // namespace weft
