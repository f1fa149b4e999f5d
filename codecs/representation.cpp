// What follows from the numbers that every representation tells.

#include "codecs/representation.h"

namespace weft {

double compression_ratio(Imath::V2i texels, std::size_t pairs, std::size_t bytes) {
  return 3.0 * texels.x * texels.y * static_cast<double>(pairs) / static_cast<double>(bytes);
}

double compression_ratio(const Representation& representation) {
  return compression_ratio(representation.texels(),
                           representation.views().size() * representation.lights().size(),
                           representation.bytes());
}

}  // namespace weft
