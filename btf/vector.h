// The vectors and colours that every part shares: Imath's, under the project's names.
#pragma once

#include <Imath/ImathColor.h>
#include <Imath/ImathVec.h>
#include <Imath/half.h>

#include <algorithm>

namespace weft {

using Vec2 = Imath::V2f;
using Vec3 = Imath::V3f;
/// Texture coordinates (u, v); they repeat with period 1, negative ones too.
using Texcoord = Imath::V2f;
/// Linear, Rec. 709 primaries.
using Rgb = Imath::C3f;
using Imath::half;

/// Mean of the three channels; for weights, not for perception.
inline float mean(const Rgb& c) {
  return (c.x + c.y + c.z) * (1.0F / 3.0F);
}
inline float max_component(const Rgb& c) {
  return std::max({c.x, c.y, c.z});
}

}  // namespace weft
