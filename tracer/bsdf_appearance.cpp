#include "tracer/bsdf_appearance.h"

namespace weft {

Rgb BsdfAppearance::evaluate(Texcoord, Direction light, Direction view, float) const {
  return bsdf_.evaluate(light, view);
}

}  // namespace weft
