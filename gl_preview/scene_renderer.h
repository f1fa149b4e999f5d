// Draws a scene on the GPU into a float picture: the one harness for all codecs, in a window or
// headless.
//
// A first pass interpolates world position, normal, tangent and texcoord at every pixel's centre; a
// second one makes the local frame that the path tracer makes, and sums btf_evaluate(uv, light,
// view, lod) * E_perp over the lights. So each pixel is shaded once, however small the triangles
// and however many lie behind each other. No shadows are cast; the background is black.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "gl_preview/preview_lights.h"
#include "images/image.h"
#include "tracer/scene.h"

namespace weft {

/// Level of detail: a fixed one (0: the finest), or each pixel's own footprint where absent.
using FixedLod = std::optional<float>;

class SceneRenderer {
 public:
  /// Uploads meshes and appearances into the current OpenGL 4.5 context, which must outlive this,
  /// and compiles one program a distinct appearance. The scene is not kept.
  /// @throws Error  naming the shape, material or texture that cannot be drawn, and why.
  explicit SceneRenderer(const Scene& scene);
  ~SceneRenderer();
  SceneRenderer(SceneRenderer&&) noexcept;
  SceneRenderer& operator=(SceneRenderer&&) noexcept;

  /// Draws `camera`'s picture into a target of its own (RGBA, 32-bit float, sampled at pixel
  /// centres). Leaves another framebuffer bound. Does not wait for the GPU.
  void draw(const Camera& camera, const PreviewLights& lights, FixedLod lod);

  /// The last picture drawn, rows from the top, linear. Waits for the GPU.
  Image read() const;
  /// GL name of the texture drawn to; row 0 is the top.
  unsigned picture() const;
  /// Texture bytes of all appearances.
  std::size_t bytes() const;

 private:
  struct Gpu;
  std::unique_ptr<Gpu> gpu_;
};

}  // namespace weft
