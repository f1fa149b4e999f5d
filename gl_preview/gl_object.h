// Owners of OpenGL names: each deletes its object when it goes. A context must be current then.
#pragma once

#include <epoxy/gl.h>

#include <utility>

namespace weft {

/// A move-only owner of one GL name; `Traits` makes and deletes it.
template <typename Traits>
class GlObject {
 public:
  GlObject() = default;
  static GlObject make() {
    GlObject object;
    object.name_ = Traits::make();
    return object;
  }
  ~GlObject() { reset(); }
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    if (this != &other) {
      reset();
      name_ = std::exchange(other.name_, 0);
    }
    return *this;
  }

  GLuint name() const { return name_; }

 private:
  void reset() {
    if (name_ != 0) Traits::destroy(name_);
    name_ = 0;
  }

  GLuint name_ = 0;
};

struct GlBufferTraits {
  static GLuint make() {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    return name;
  }
  static void destroy(GLuint name) { glDeleteBuffers(1, &name); }
};

template <GLenum Target>
struct GlTextureTraits {
  static GLuint make() {
    GLuint name = 0;
    glCreateTextures(Target, 1, &name);
    return name;
  }
  static void destroy(GLuint name) { glDeleteTextures(1, &name); }
};

struct GlFramebufferTraits {
  static GLuint make() {
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    return name;
  }
  static void destroy(GLuint name) { glDeleteFramebuffers(1, &name); }
};

struct GlVertexArrayTraits {
  static GLuint make() {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    return name;
  }
  static void destroy(GLuint name) { glDeleteVertexArrays(1, &name); }
};

struct GlProgramTraits {
  static GLuint make() { return glCreateProgram(); }
  static void destroy(GLuint name) { glDeleteProgram(name); }
};

template <GLenum Stage>
struct GlShaderTraits {
  static GLuint make() { return glCreateShader(Stage); }
  static void destroy(GLuint name) { glDeleteShader(name); }
};

using GlBuffer = GlObject<GlBufferTraits>;
using GlFramebuffer = GlObject<GlFramebufferTraits>;
using GlVertexArray = GlObject<GlVertexArrayTraits>;
using GlLinkedProgram = GlObject<GlProgramTraits>;
template <GLenum Target>
using GlTextureName = GlObject<GlTextureTraits<Target>>;
template <GLenum Stage>
using GlShader = GlObject<GlShaderTraits<Stage>>;

}  // namespace weft
