#include "acquisition/mesostructures/noise.h"

#include <cmath>
#include <numbers>

#include "btf/random.h"

namespace weft {

namespace {

double fade(double t) {
  return t * t * t * (t * (t * 6 - 15) + 10);
}

int wrapped(int i, int n) {
  return (i % n + n) % n;
}

/// Offset . gradient, where the gradient is a unit vector of a random direction.
double slope(const Imath::V2d& offset, std::uint64_t hash) {
  const double angle = 2 * std::numbers::pi * unit_float(hash);
  return offset.x * std::cos(angle) + offset.y * std::sin(angle);
}

double slope(const Imath::V3d& offset, std::uint64_t hash) {
  const double z = 2 * static_cast<double>(unit_float(hash)) - 1;
  const double angle = 2 * std::numbers::pi * unit_float(mix_bits(hash));
  const double across = std::sqrt(1 - z * z);
  return across * (offset.x * std::cos(angle) + offset.y * std::sin(angle)) + z * offset.z;
}

}  // namespace

double periodic_noise(const Imath::V2d& p, Imath::V2i cells, std::uint64_t seed) {
  const double x = p.x * cells.x;
  const double y = p.y * cells.y;
  const int i = static_cast<int>(std::floor(x));
  const int j = static_cast<int>(std::floor(y));
  double sum = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const int ci = i + corner % 2;
    const int cj = j + corner / 2;
    const Imath::V2d offset(x - ci, y - cj);
    const double weight = fade(1 - std::abs(offset.x)) * fade(1 - std::abs(offset.y));
    sum +=
        weight * slope(offset, hash_coordinates(seed, wrapped(ci, cells.x), wrapped(cj, cells.y)));
  }
  return sum;
}

double periodic_fractal_noise(const Imath::V2d& p, Imath::V2i cells, int octaves,
                              std::uint64_t seed) {
  double sum = 0;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += periodic_noise(p, cells * (1 << octave), hash_coordinates(seed, octave)) / (1 << octave);
  }
  return sum;
}

double space_noise(const Imath::V3d& p, std::uint64_t seed) {
  const int i = static_cast<int>(std::floor(p.x));
  const int j = static_cast<int>(std::floor(p.y));
  const int k = static_cast<int>(std::floor(p.z));
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int ci = i + corner % 2;
    const int cj = j + corner / 2 % 2;
    const int ck = k + corner / 4;
    const Imath::V3d offset(p.x - ci, p.y - cj, p.z - ck);
    const double weight =
        fade(1 - std::abs(offset.x)) * fade(1 - std::abs(offset.y)) * fade(1 - std::abs(offset.z));
    sum += weight * slope(offset, hash_coordinates(seed, ci, cj, ck));
  }
  return sum;
}

}  // namespace weft
