// Drawing and timing without a display.

#include "gl_preview/headless.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "gl_preview/gl_context.h"

namespace weft {

namespace {

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
      .count();
}

}  // namespace

HeadlessPicture preview_headless(const Scene& scene, const HeadlessOptions& options) {
  const GlContext context;
  HeadlessPicture result;
  result.renderer = gl_renderer();
  const auto begin = std::chrono::steady_clock::now();
  SceneRenderer renderer(scene);
  const PreviewLights lights = preview_lights(scene);
  glFinish();
  result.upload_ms = milliseconds_since(begin);
  // The first frame warms up: drivers compile and copy only when something is drawn.
  renderer.draw(scene.camera, lights, options.lod);
  result.image = renderer.read();
  result.bytes = renderer.bytes();
  double best = std::numeric_limits<double>::infinity();
  double sum = 0;
  for (int i = 0; i < options.timed_frames; ++i) {
    const auto frame_begin = std::chrono::steady_clock::now();
    renderer.draw(scene.camera, lights, options.lod);
    glFinish();
    const double took = milliseconds_since(frame_begin);
    best = std::min(best, took);
    sum += took;
  }
  if (options.timed_frames > 0) {
    result.ms_per_frame = sum / options.timed_frames;
    result.best_ms = best;
  }
  return result;
}

}  // namespace weft
