#include "acquisition/mesostructures/cells.h"

#include <cmath>

#include "btf/random.h"

namespace weft {

namespace {

int wrapped(int i, int n) {
  return (i % n + n) % n;
}

}  // namespace

double CellPlace::rise(double width) const {
  double product = 1;
  for (const double d : border) product *= 1 - std::exp(-(d / width) * (d / width));
  return product;
}

CellPlace PeriodicCells::at(const Imath::V2d& p) const {
  const Imath::V2d place(p.x * squares_.x, p.y * squares_.y);
  const int column = static_cast<int>(std::floor(place.x));
  const int row = static_cast<int>(std::floor(place.y));
  std::array<Imath::V2d, 25> points;
  std::array<std::uint64_t, 25> hashes;
  int nearest = 0;
  for (int k = 0; k < 25; ++k) {
    const int i = column + k % 5 - 2;
    const int j = row + k / 5 - 2;
    hashes[k] = hash_coordinates(seed_, wrapped(i, squares_.x), wrapped(j, squares_.y));
    const Imath::V2d random(unit_float(hashes[k]), unit_float(mix_bits(hashes[k] + 1)));
    points[k] = Imath::V2d(i + 0.5, j + 0.5) + (random - Imath::V2d(0.5)) * jitter_;
    if ((points[k] - place).length2() < (points[nearest] - place).length2()) nearest = k;
  }
  CellPlace result{};
  result.hash = mix_bits(hashes[nearest] + 2);
  const double own = (points[nearest] - place).length2();
  for (int k = 0, d = 0; k < 25; ++k) {
    if (k == nearest) continue;
    const double apart = (points[k] - points[nearest]).length();
    result.border[d++] = ((points[k] - place).length2() - own) / (2 * apart);
  }
  return result;
}

}  // namespace weft
