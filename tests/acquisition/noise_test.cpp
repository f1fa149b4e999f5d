// Gradient noise: periodic, smooth, within its range, of mean zero.
#include "acquisition/mesostructures/noise.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace weft;

TEST_CASE("noise repeats with the tile, and is 0 at the corners of its lattice") {
  const Imath::V2i cells(3, 7);
  double largest = 0;
  for (int i = 0; i < 200; ++i) {
    const Imath::V2d p(0.013 * i, 0.41 + 0.0077 * i);
    const double here = periodic_noise(p, cells, 5);
    largest = std::max(largest, std::abs(here));
    CHECK(periodic_noise(p + Imath::V2d(1, 0), cells, 5) == Approx(here).margin(1e-9));
    CHECK(periodic_noise(p + Imath::V2d(-2, 3), cells, 5) == Approx(here).margin(1e-9));
    CHECK(periodic_fractal_noise(p + Imath::V2d(1, -1), cells, 4, 5) ==
          Approx(periodic_fractal_noise(p, cells, 4, 5)).margin(1e-9));
  }
  CHECK(largest > 0.2);
  CHECK(periodic_noise({2.0 / 3, 5.0 / 7}, cells, 5) == Approx(0).margin(1e-12));
  CHECK(periodic_noise({0.1, 0.2}, cells, 5) != periodic_noise({0.1, 0.2}, cells, 6));
}

TEST_CASE("noise has mean 0, keeps its range, and its slope has no jumps") {
  double sum = 0;
  double space_sum = 0;
  double largest = 0;
  double largest_in_space = 0;
  double jump = 0;
  double steepest = 0;
  constexpr int n = 20000;
  constexpr double step = 1e-3;
  const auto along = [](double t) { return space_noise({t, 0.3 * t + 5.2, 1.7 - 0.2 * t}, 9); };
  for (int i = 0; i < n; ++i) {
    const double t = i * step * 7;
    const double flat = periodic_noise({t / 40, 0.37 * t / 40}, {40, 40}, 9);
    sum += flat / n;
    space_sum += along(t) / n;
    largest = std::max(largest, std::abs(flat));
    largest_in_space = std::max(largest_in_space, std::abs(along(t)));
    const double left = (along(t) - along(t - step)) / step;
    const double right = (along(t + step) - along(t)) / step;
    jump = std::max(jump, std::abs(right - left));
    steepest = std::max(steepest, std::abs(right));
  }
  CHECK(std::abs(sum) < 0.05);
  CHECK(std::abs(space_sum) < 0.05);
  CHECK(largest < 0.71);
  CHECK(largest_in_space < 0.87);
  CHECK(largest_in_space > 0.3);
  CHECK(steepest > 0.5);
  CHECK(jump < 20 * step);
}
