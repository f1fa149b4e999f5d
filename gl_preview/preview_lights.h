// The lights that a fragment sums over: points and directions. Environments become directions.
#pragma once

#include <vector>

#include "tracer/scene.h"

namespace weft {

/// Each environment becomes at most this many directional lights.
constexpr int lights_per_environment = 32;

struct PreviewLights {
  std::vector<PointLight> points;
  std::vector<DirectionalLight> directionals;
};

/// The scene's own point and directional lights, then those of its environments.
PreviewLights preview_lights(const Scene& scene);

/// Splits the picture into regions of equal power by median cut [Debevec, "A median cut algorithm
/// for light probe sampling", 2005]; each region becomes one light, of its irradiance (W/m^2) from
/// its mean direction. Deterministic.
std::vector<DirectionalLight> median_cut(const EnvironmentLight& environment, int most_lights);

}  // namespace weft
