// The film: filters, means, variances, and samples that are not numbers.

#include "tracer/film.h"

#include <cmath>
#include <limits>

#include "btf/random.h"

namespace weft {
namespace {

TEST_CASE("Mean and variance of a pixel's samples", "[film]") {
  Film film(2, 2);
  for (const float value : {1.0F, 2.0F, 6.0F}) film.add(1, 0, {value, 0.5F, 0});
  const Image image = film.image(), variance = film.variance();
  CHECK(image.rgb(1, 0) == Rgb(3, 0.5F, 0));
  CHECK(image.rgb(0, 1) == Rgb(0, 0, 0));
  CHECK(variance.rgb(1, 0).x == Approx(7.0 / 3));  // 14 / 2 over 3 samples
  CHECK(variance.rgb(1, 0).y == 0);
}

TEST_CASE("Samples that are not finite are left out and counted with their place", "[film]") {
  Film film(4, 4);
  film.add(2, 3, {std::numeric_limits<float>::quiet_NaN(), 0, 0});
  film.add(2, 3, {4, 4, 4});
  film.add(3, 3, {0, std::numeric_limits<float>::infinity(), 0});
  film.add(0, 0, {-1, 1, 1});
  const Film::Invalid invalid = film.invalid();
  CHECK(invalid.not_finite == 2);
  CHECK(invalid.negative == 1);
  REQUIRE(invalid.first);
  CHECK(*invalid.first == std::array{2, 3});
  CHECK(film.image().rgb(2, 3) == Rgb(4, 4, 4));
  CHECK(film.image().rgb(0, 0).x == -1);
}

TEST_CASE("Filters have their width", "[film]") {
  CHECK(filter_offset(PixelFilter::centre, 0.9F, 0.1F) == std::array{0.5, 0.5});
  CHECK(filter_offset(PixelFilter::box, 0.25F, 0.75F) == std::array{0.25, 0.75});
  double squares = 0, farthest = 0;
  constexpr int count = 20000;
  for (int i = 0; i < count; ++i) {
    const auto [x, y] = filter_offset(PixelFilter::gaussian, unit_float(hash_coordinates(i, 0)),
                                      unit_float(hash_coordinates(i, 1)));
    squares += (x - 0.5) * (x - 0.5) / count;
    farthest = std::max(farthest, std::hypot(x - 0.5, y - 0.5));
  }
  CHECK(farthest <= 1.5);
  // Cut at three standard deviations: 0.25 (1 - 4.5 e^-4.5 / (1 - e^-4.5)).
  CHECK(squares == Approx(0.25 * (1 - 4.5 * std::exp(-4.5) / (1 - std::exp(-4.5)))).epsilon(0.03));
}

}  // namespace
}  // namespace weft
