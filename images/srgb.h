// The sRGB transfer curve (IEC 61966-2-1) between linear light and what 8-bit pictures store.
#pragma once

#include <cmath>

namespace weft {

/// Linear value in [0, 1] to its sRGB code value in [0, 1].
inline float srgb_encoded(float linear) {
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

/// sRGB code value in [0, 1] to linear light.
inline float srgb_decoded(float code) {
  return code <= 0.04045F ? code / 12.92F : std::pow((code + 0.055F) / 1.055F, 2.4F);
}

}  // namespace weft
