// Making and binding a framebuffer.

#include "gl_preview/render_target.h"

#include <fmt/core.h>

#include "btf/error.h"
#include "gl_preview/gl_context.h"

namespace weft {

RenderTarget::RenderTarget(int width, int height, GLenum format, bool with_depth)
    : width_(width),
      height_(height),
      colour_(GlTextureName<GL_TEXTURE_2D>::make()),
      framebuffer_(GlFramebuffer::make()) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  const std::string doing = fmt::format("picture of {} x {}", width, height);
  if (width < 1 || height < 1 || width > most || height > most) {
    throw failed(doing, fmt::format("this GPU draws 1 to {} pixels a side", most));
  }
  glTextureStorage2D(colour_.name(), 1, format, width, height);
  glTextureParameteri(colour_.name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(colour_.name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, colour_.name(), 0);
  if (with_depth) {
    depth_ = GlTextureName<GL_TEXTURE_2D>::make();
    glTextureStorage2D(depth_.name(), 1, GL_DEPTH_COMPONENT32F, width, height);
    glNamedFramebufferTexture(framebuffer_.name(), GL_DEPTH_ATTACHMENT, depth_.name(), 0);
  }
  check_gl(doing);
  if (glCheckNamedFramebufferStatus(framebuffer_.name(), GL_DRAW_FRAMEBUFFER) !=
      GL_FRAMEBUFFER_COMPLETE) {
    throw failed(doing, "this GPU cannot draw to such a picture");
  }
}

void RenderTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, width_, height_);
}

}  // namespace weft
