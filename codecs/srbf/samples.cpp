#include "codecs/srbf/samples.h"

namespace weft::srbf {

Samples::Samples(const HemisphereSampling& views, const HemisphereSampling& lights,
                 Quantity quantity)
    : pairs(views.size() * lights.size()),
      count((pairs + block_samples - 1) / block_samples * block_samples) {
  for (std::size_t c = 0; c < 3; ++c) {
    light[c].resize(count);
    view[c].resize(count);
  }
  cosine.resize(count);
  gain.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_pair = i < pairs;
    const Direction l = is_pair ? lights[i % lights.size()] : Direction(0, 0, 1);
    const Direction v = is_pair ? views[i / lights.size()] : Direction(0, 0, 1);
    for (int c = 0; c < 3; ++c) {
      light[c][i] = l[c];
      view[c][i] = v[c];
    }
    cosine[i] = l ^ v;
    if (!is_pair || !(l.z > 0) || !(v.z > 0)) continue;
    gain[i] = quantity == Quantity::over_cosine ? l.z : 1;
  }
}

std::vector<float> channel_arrays(const Samples& samples, std::span<const float> abrdf,
                                  double scale) {
  std::vector<float> channels(3 * samples.count);
  for (std::size_t i = 0; i < samples.pairs; ++i) {
    if (samples.gain[i] == 0) continue;
    for (std::size_t c = 0; c < 3; ++c)
      channels[c * samples.count + i] = static_cast<float>(abrdf[3 * i + c] / scale);
  }
  return channels;
}

}  // namespace weft::srbf
