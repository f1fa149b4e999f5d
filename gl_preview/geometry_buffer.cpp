// Making, clearing and binding the G-buffer.

#include "gl_preview/geometry_buffer.h"

#include <fmt/core.h>

#include <array>

#include "gl_preview/gl_context.h"
#include "gl_preview/render_target.h"

namespace weft {

namespace {

constexpr std::array<GLenum, 3> attachments = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1,
                                               GL_COLOR_ATTACHMENT2};

}  // namespace

GeometryBuffer::GeometryBuffer(int width, int height)
    : width_(width),
      height_(height),
      depth_stencil_(GlTextureName<GL_TEXTURE_2D>::make()),
      geometry_framebuffer_(GlFramebuffer::make()),
      picture_framebuffer_(GlFramebuffer::make()) {
  check_picture_size(width, height);
  picture_ = picture_texture(width, height, GL_RGBA32F);
  glTextureStorage2D(depth_stencil_.name(), 1, GL_DEPTH32F_STENCIL8, width, height);
  for (int i = 0; i < texture_count; ++i) {
    textures_[i] = picture_texture(width, height, GL_RGBA32F);
    glNamedFramebufferTexture(geometry_framebuffer_.name(), attachments[i], textures_[i].name(), 0);
  }
  glNamedFramebufferDrawBuffers(geometry_framebuffer_.name(), texture_count, attachments.data());
  glNamedFramebufferTexture(picture_framebuffer_.name(), GL_COLOR_ATTACHMENT0, picture_.name(), 0);
  for (const GlFramebuffer* framebuffer : {&geometry_framebuffer_, &picture_framebuffer_}) {
    glNamedFramebufferTexture(framebuffer->name(), GL_DEPTH_STENCIL_ATTACHMENT,
                              depth_stencil_.name(), 0);
    check_framebuffer(framebuffer->name(), width, height);
  }
}

void GeometryBuffer::begin_geometry() const {
  glBindFramebuffer(GL_FRAMEBUFFER, picture_framebuffer_.name());
  glViewport(0, 0, width_, height_);
  glDepthMask(GL_TRUE);
  glStencilMask(0xFF);
  glClearColor(0, 0, 0, 0);
  glClearDepth(0);
  glClearStencil(0);
  // What the stencil leaves out of the three textures is not read.
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  glBindFramebuffer(GL_FRAMEBUFFER, geometry_framebuffer_.name());
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glEnable(GL_STENCIL_TEST);
  glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
}

void GeometryBuffer::begin_shading() const {
  glBindFramebuffer(GL_FRAMEBUFFER, picture_framebuffer_.name());
  glDisable(GL_DEPTH_TEST);
  glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
}

void GeometryBuffer::bind_textures(GLuint first_unit) const {
  for (int i = 0; i < texture_count; ++i) glBindTextureUnit(first_unit + i, textures_[i].name());
}

}  // namespace weft
