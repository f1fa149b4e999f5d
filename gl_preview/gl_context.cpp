// EGL's surfaceless platform, and GL errors as exceptions.

#include "gl_preview/gl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <vector>

#include "btf/error.h"

namespace weft {

namespace {

constexpr const char* egl_hint =
    "Mesa's software driver is in Debian's libgl1-mesa-dri and libegl1";

EGLDisplay open_display() {
  // Asked of the loader itself: epoxy ends the program where a function is not there.
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base") ||
      !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
    throw failed("headless preview", "EGL here has no surfaceless platform", egl_hint);
  }
  EGLDisplay display =
      eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE) {
    throw failed("headless preview",
                 fmt::format("EGL's surfaceless display cannot be opened (EGL error {:#x})",
                             static_cast<unsigned>(eglGetError())),
                 egl_hint);
  }
  return display;
}

EGLContext make_context(EGLDisplay display) {
  eglBindAPI(EGL_OPENGL_API);
  const std::array<EGLint, 9> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                            4,
                                            EGL_CONTEXT_MINOR_VERSION,
                                            5,
                                            EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                            EGL_CONTEXT_OPENGL_DEBUG,
                                            EGL_TRUE,
                                            EGL_NONE};
  return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
}

std::string logged_messages() {
  std::string messages;
  std::vector<GLchar> text(4096);
  GLsizei length = 0;
  while (glGetDebugMessageLog(1, static_cast<GLsizei>(text.size()), nullptr, nullptr, nullptr,
                              nullptr, &length, text.data()) == 1) {
    if (messages.empty()) messages.assign(text.data(), length > 0 ? length - 1 : 0);
  }
  while (!messages.empty() && messages.back() == '\n') messages.pop_back();
  return messages;
}

std::string error_name(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "invalid enum";
    case GL_INVALID_VALUE:
      return "invalid value";
    case GL_INVALID_OPERATION:
      return "invalid operation";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "invalid framebuffer operation";
    default:
      return fmt::format("error {:#x}", error);
  }
}

}  // namespace

struct GlContext::Egl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;

  ~Egl() {
    if (display == EGL_NO_DISPLAY) return;
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
    // The display is the process's and stays: the next context opens the same one, and a driver
    // that is unloaded with it leaves memory behind.
  }
};

GlContext::GlContext() : egl_(std::make_unique<Egl>()) {
  egl_->display = open_display();
  egl_->context = make_context(egl_->display);
  if (egl_->context == EGL_NO_CONTEXT) {
    throw failed("headless preview",
                 fmt::format("EGL refuses an OpenGL 4.5 core context (EGL error {:#x})",
                             static_cast<unsigned>(eglGetError())),
                 egl_hint);
  }
  if (eglMakeCurrent(egl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl_->context) == EGL_FALSE) {
    throw failed("headless preview", "EGL cannot use a context without a surface", egl_hint);
  }
  start_gl_error_log();
}

GlContext::~GlContext() = default;

void start_gl_error_log() {
  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DONT_CARE, 0, nullptr, GL_FALSE);
  glDebugMessageControl(GL_DEBUG_SOURCE_API, GL_DEBUG_TYPE_ERROR, GL_DONT_CARE, 0, nullptr,
                        GL_TRUE);
}

void check_gl(const std::string& doing) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  // A lost context answers with an error for ever; a few are all that can be queued.
  for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; ++i) continue;
  const std::string messages = logged_messages();
  if (error == GL_OUT_OF_MEMORY) {
    throw failed(doing, "the GPU (or its driver) is out of memory",
                 "use a smaller or a compressed dataset");
  }
  throw failed(doing, "OpenGL: " + (messages.empty() ? error_name(error) : messages));
}

std::string gl_renderer() {
  const auto text = [](GLenum name) {
    const GLubyte* value = glGetString(name);
    return std::string(value ? reinterpret_cast<const char*>(value) : "unknown");
  };
  return text(GL_RENDERER) + ", " + text(GL_VERSION);
}

}  // namespace weft
