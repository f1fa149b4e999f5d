// The preview without a window or display: one picture and how long a frame takes.
#pragma once

#include <cstddef>
#include <string>

#include "gl_preview/scene_renderer.h"

namespace weft {

struct HeadlessOptions {
  FixedLod lod = 0.0F;   ///< absent: from each pixel's footprint
  int timed_frames = 0;  ///< frames drawn again after the first, to be timed
};

struct HeadlessPicture {
  Image image;  ///< of the camera's size, linear, rows from the top, sampled at pixel centres
  double ms_per_frame = 0;  ///< mean over `timed_frames`, each waited for; 0 where there are none
  double best_ms = 0;       ///< the fastest of them
  double upload_ms = 0;     ///< uploading textures and compiling shaders
  std::size_t bytes = 0;    ///< of textures uploaded
  std::string renderer;     ///< the GPU or driver that drew it
};

/// @throws Error  failed, where there is no EGL or the GPU's limits are met; bad_input, naming what
/// cannot be drawn.
HeadlessPicture preview_headless(const Scene& scene, const HeadlessOptions& options);

}  // namespace weft
