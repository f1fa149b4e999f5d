// What follows from the numbers that every representation tells.

#include "codecs/representation.h"

namespace weft {

double compression_ratio(const Representation& representation) {
  const Imath::V2i texels = representation.texels();
  const double raw = 3.0 * texels.x * texels.y *
                     static_cast<double>(representation.views().size()) *
                     static_cast<double>(representation.lights().size());
  return raw / static_cast<double>(representation.bytes());
}

}  // namespace weft
