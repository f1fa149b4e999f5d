// Makes a flat Lambertian BTF, writes it, opens it as a codec's and asks it, and traces another,
// through what is installed only.

#include <cmath>
#include <cstdio>
#include <numbers>

#include "btf/btf.h"
#include "btf/btf_file.h"
#include "btf/direction.h"
#include "codecs/representation.h"
#include "tracing.h"

namespace {

constexpr double albedo = 0.5;

weft::Btf lambert() {
  const weft::HemisphereSampling sampling(weft::named_directions("ubo81"));
  weft::Btf btf(2, 2, sampling, sampling, weft::PixelType::float32);
  for (std::size_t view = 0; view < sampling.size(); ++view) {
    for (std::size_t light = 0; light < sampling.size(); ++light) {
      const auto value = static_cast<float>(albedo / std::numbers::pi * sampling[light].z);
      for (int i = 0; i < 4; ++i)
        btf.set(light, view, i % 2, i / 2, weft::Rgb(value, value, value));
    }
  }
  return btf;
}

}  // namespace

int main() {
  weft::write_btf("lambert.btf", lambert());
  const auto opened = weft::open_representation("lambert.btf");
  const weft::Direction light = weft::from_spherical(weft::radians(50.0), 0.3);
  const weft::Direction view = weft::from_spherical(weft::radians(20.0), 2.0);
  const float found = opened->evaluate({0.3F, 0.7F}, light, view, 0).y;
  const double expected = albedo / std::numbers::pi * light.z;
  std::printf("%s says %.6f, expected %.6f\n", opened->codec().c_str(), found, expected);
  const bool traces = trace_flat_checker() && evaluate_lanes();
  return std::abs(found - expected) < 1e-5 && traces ? 0 : 1;
}
