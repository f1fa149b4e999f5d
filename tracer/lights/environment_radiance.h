// What the radiance of an environment may be, and how a picture from a file is made so.
#pragma once

#include <cstdint>

#include "tracer/scene.h"

namespace weft {

/// Makes finite values below 0 zero. Pictures of real light hold a few: resampling with a filter
/// that has negative lobes leaves them beside the sun. @return how many values were.
std::int64_t clear_negative_values(Image& radiance);

/// @throws Error  bad_input where a pixel is negative, not finite or has a mean that no float
/// holds, naming the light and the pixel.
void check_radiance(const EnvironmentLight& light);

}  // namespace weft
