// The preview in a window: several datasets side by side, an error map, orbit, light drag,
// exposure.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gl_preview/scene_renderer.h"

namespace weft {

struct PreviewPane {
  std::string title;
  Scene scene;
};

struct WindowOptions {
  FixedLod lod = 0.0F;  ///< at first; the window has a choice
  int frames = 0;  ///< closes after so many frames, each drawn anew; 0: when the user closes it
  std::filesystem::path screenshot;  ///< of the whole window's last frame, if not empty
};

struct WindowResult {
  int frames = 0;
  std::vector<double> ms_per_frame;  ///< a pane each: mean over its frames after the first
  std::vector<std::size_t> bytes;    ///< a pane each: of textures uploaded
  std::string renderer;
};

/// Shows `panes` (at least one) from the first one's camera under its lights. The first is the
/// reference of the error map. @throws Error failed, where there is no display; as `SceneRenderer`.
WindowResult preview_window(std::vector<PreviewPane> panes, const WindowOptions& options);

}  // namespace weft
