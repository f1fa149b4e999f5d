#include "cli/scene_light.h"

#include <fmt/core.h>

namespace weft::cli {

void report_light(const Scene& scene, Session& session) {
  if (scene.point_lights.empty() && scene.directional_lights.empty() &&
      scene.environments.empty()) {
    session.warn("the scene has no light, so the picture is black");
  }
  std::int64_t negative_values = 0;
  for (const EnvironmentLight& light : scene.environments) {
    negative_values += light.negative_values;
    if (light.negative_values > 0) {
      session.warn(fmt::format("{}: {} of {} values were negative; they are taken as 0", light.name,
                               light.negative_values, light.radiance.values.size()));
    }
  }
  session.measured["environment_negative_values"] = negative_values;
}

}  // namespace weft::cli
