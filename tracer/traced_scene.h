// A scene made ready for rays: the camera's geometry, Embree's structure and the environments'
// distributions.
#pragma once

#include <vector>

#include "tracer/camera.h"
#include "tracer/lights/environment_sampler.h"
#include "tracer/ray_scene.h"
#include "tracer/scene.h"

namespace weft {

struct TracedScene {
  /// Keeps a reference to `scene`. @throws Error where a shape has no triangles, or lacks normals,
  /// texcoords or tangents at a vertex, or names a material that is not there.
  explicit TracedScene(const Scene& scene);

  const Scene& scene;
  PerspectiveCamera camera;
  RayScene rays;
  std::vector<EnvironmentSampler> environments;
};

}  // namespace weft
