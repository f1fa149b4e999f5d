#include "cli/dark_scene.h"

namespace weft::cli {

void warn_where_dark(const Scene& scene, const Session& session) {
  if (scene.point_lights.empty() && scene.directional_lights.empty() &&
      scene.environments.empty()) {
    session.warn("the scene has no light, so the picture is black");
  }
}

}  // namespace weft::cli
