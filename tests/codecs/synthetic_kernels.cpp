#include "tests/codecs/synthetic_kernels.h"

#include <algorithm>

#include "btf/random.h"
#include "tests/codecs/synthetic_btf.h"

namespace weft::srbf {

namespace {

double random(std::uint64_t i, int what) {
  return 2.0 * unit_float(hash_coordinates(91, i, what)) - 1;
}

}  // namespace

Kernels some_kernels(Shape shape, double widest, std::uint64_t seed) {
  Kernels kernels(shape);
  for (std::size_t i = 0; i < shape.centres(); ++i)
    kernels.values()[i] = widest * 0.57 * random(i, static_cast<int>(2 * seed));
  const std::vector<double> angles = {0.8, 0.1, 1.4, -0.7};
  std::copy_n(angles.begin(), shape.modes, kernels.angles().begin());
  for (std::size_t i = 0; i < shape.colours(); ++i)
    kernels.colours()[i] = 1 + 0.5 * random(i, static_cast<int>(2 * seed + 1));
  return kernels;
}

std::shared_ptr<const Btf> btf_of(const std::vector<Kernels>& texels, int width,
                                  const std::string& directions) {
  const int height = static_cast<int>(texels.size()) / width;
  return synthetic_btf(width, height, directions, directions,
                       [&](int x, int y, const Direction& light, const Direction& view) {
                         const auto b = evaluate(texels[y * width + x], light, view);
                         return Rgb(static_cast<float>(b[0]), static_cast<float>(b[1]),
                                    static_cast<float>(b[2])) /
                                light.z;
                       });
}

std::vector<float> texel_of(const Btf& btf, const Samples& samples, int x, int y) {
  std::vector<float> abrdf(3 * samples.pairs);
  btf.abrdf(x, y, abrdf);
  return channel_arrays(samples, abrdf, 1);
}

}  // namespace weft::srbf
