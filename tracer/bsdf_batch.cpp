#include "tracer/bsdf_batch.h"

namespace weft {

void evaluate_lights(const Bsdf& bsdf, const LightBatch& lights, const Direction& view,
                     RgbBatch& values) {
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const Rgb value = bsdf.evaluate({lights.x[i], lights.y[i], lights.z[i]}, view);
    values.r[i] = value.x;
    values.g[i] = value.y;
    values.b[i] = value.z;
  }
}

}  // namespace weft
