// A picture on the GPU: a colour texture, and depth where asked for. Row 0 is the top when drawn to
// with `GL_UPPER_LEFT`.
#pragma once

#include "gl_preview/gl_object.h"

namespace weft {

class RenderTarget {
 public:
  RenderTarget() = default;
  /// @param format  GL_RGBA32F or GL_RGBA8. @throws Error failed, naming the size that is too
  /// large.
  RenderTarget(int width, int height, GLenum format, bool with_depth);

  int width() const { return width_; }
  int height() const { return height_; }
  GLuint framebuffer() const { return framebuffer_.name(); }
  GLuint texture() const { return colour_.name(); }
  /// Binds the framebuffer and sets the viewport to all of it.
  void bind() const;

 private:
  int width_ = 0;
  int height_ = 0;
  GlTextureName<GL_TEXTURE_2D> colour_;
  GlTextureName<GL_TEXTURE_2D> depth_;
  GlFramebuffer framebuffer_;
};

}  // namespace weft
