// Turning a camera or a light about a point, as the mouse asks.
#pragma once

#include "gl_preview/preview_lights.h"
#include "tracer/scene.h"

namespace weft {

/// `offset` turned by `azimuth` about `up` (unit, counter-clockwise from above) and raised by
/// `elevation`, which stops at 89 degrees above and below. Radians; the length stays.
Vec3 turned(const Vec3& offset, const Vec3& up, float azimuth, float elevation);

/// The camera turned about its target.
Camera orbited(Camera camera, float azimuth, float elevation);

/// The camera at `factor` times the distance from its target.
Camera dollied(Camera camera, float factor);

/// The first light turned: a point light about `centre`, a directional light's direction.
PreviewLights with_first_light_turned(PreviewLights lights, const Vec3& centre, const Vec3& up,
                                      float azimuth, float elevation);

}  // namespace weft
