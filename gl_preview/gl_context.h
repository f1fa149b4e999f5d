// An OpenGL 4.5 core context without a window or display (EGL surfaceless), and how its errors
// become ours.
#pragma once

#include <memory>
#include <string>

namespace weft {

/// Current in the thread that made it, until it goes.
class GlContext {
 public:
  /// @throws Error failed, saying what EGL lacks.
  GlContext();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

 private:
  struct Egl;
  std::unique_ptr<Egl> egl_;
};

/// Asks the current context to log errors (KHR_debug) for `check_gl`.
void start_gl_error_log();

/// @throws Error failed, "DOING: ..." with the driver's own words, where OpenGL reported an error
/// since the last call.
///         Too little memory is told in plain words.
void check_gl(const std::string& doing);

/// Name and version of what draws, e.g. "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile)
/// Mesa 22.3.6".
std::string gl_renderer();

}  // namespace weft
