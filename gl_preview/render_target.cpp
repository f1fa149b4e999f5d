// Making and binding a framebuffer.

#include "gl_preview/render_target.h"

#include <fmt/core.h>

#include "btf/error.h"
#include "gl_preview/gl_context.h"

namespace weft {

namespace {

std::string name_of_picture(int width, int height) {
  return fmt::format("picture of {} x {}", width, height);
}

}  // namespace

void check_picture_size(int width, int height) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  if (width < 1 || height < 1 || width > most || height > most) {
    throw failed(name_of_picture(width, height),
                 fmt::format("this GPU draws 1 to {} pixels a side", most));
  }
}

GlTextureName<GL_TEXTURE_2D> picture_texture(int width, int height, GLenum format) {
  auto texture = GlTextureName<GL_TEXTURE_2D>::make();
  glTextureStorage2D(texture.name(), 1, format, width, height);
  glTextureParameteri(texture.name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(texture.name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return texture;
}

void check_framebuffer(GLuint framebuffer, int width, int height) {
  check_gl(name_of_picture(width, height));
  if (glCheckNamedFramebufferStatus(framebuffer, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw failed(name_of_picture(width, height), "this GPU cannot draw to such a picture");
  }
}

RenderTarget::RenderTarget(int width, int height, GLenum format)
    : width_(width), height_(height), framebuffer_(GlFramebuffer::make()) {
  check_picture_size(width, height);
  colour_ = picture_texture(width, height, format);
  glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, colour_.name(), 0);
  check_framebuffer(framebuffer_.name(), width, height);
}

void RenderTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, width_, height_);
}

}  // namespace weft
