// Random cells: distances to their borders, smooth rises over them, and their period.
#include "acquisition/mesostructures/cells.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

using namespace weft;

TEST_CASE("without jitter cells are squares, and distances those to their sides") {
  const PeriodicCells cells({5, 4}, 0, 1);
  const auto nearest = [&](double x, double y) {
    const CellPlace place = cells.at({x / 5, y / 4});
    return *std::min_element(place.border.begin(), place.border.end());
  };
  CHECK(nearest(2.5, 1.5) == Approx(0.5));
  CHECK(nearest(2.9, 1.5) == Approx(0.1));
  CHECK(nearest(2.1, 1.05) == Approx(0.05));
  CHECK(cells.at({0.5, 0.375}).rise(0.1) == Approx(1).margin(1e-6));
  CHECK(cells.at({0.4, 0.375}).rise(0.1) == Approx(0).margin(1e-12));
  // Far from all but one border the rise is the formula's alone.
  CHECK(cells.at({2.9 / 5, 1.5 / 4}).rise(0.1) == Approx(1 - std::exp(-1.0)));
}

TEST_CASE("cells repeat with the tile, and there are as many as squares") {
  const PeriodicCells cells({6, 4}, 1, 3);
  std::set<std::uint64_t> seen;
  for (int j = 0; j < 80; ++j) {
    for (int i = 0; i < 80; ++i) {
      const Imath::V2d p(i / 80.0, j / 80.0);
      const CellPlace here = cells.at(p);
      seen.insert(here.hash);
      for (const Imath::V2d& tile : {Imath::V2d(1, 0), Imath::V2d(-1, 2)}) {
        const CellPlace there = cells.at(p + tile);
        CHECK(there.hash == here.hash);
        CHECK(there.rise(0.2) == Approx(here.rise(0.2)).margin(1e-9));
      }
    }
  }
  CHECK(seen.size() == 24);
}

TEST_CASE("the rise over cells is smooth, across borders too") {
  const PeriodicCells cells({8, 8}, 0.9, 4);
  constexpr double step = 1e-4;
  double jump = 0;
  double steepest = 0;
  int borders = 0;
  const auto rise = [&](double t) { return cells.at({t, 0.21 + 0.3 * t}).rise(0.3); };
  for (int i = 0; i < 10000; ++i) {
    const double t = i * step;
    borders +=
        cells.at({t, 0.21 + 0.3 * t}).hash != cells.at({t + step, 0.21 + 0.3 * (t + step)}).hash;
    jump = std::max(jump, std::abs(rise(t + step) - 2 * rise(t) + rise(t - step)) / step);
    steepest = std::max(steepest, std::abs(rise(t + step) - rise(t)) / step);
  }
  CHECK(borders > 5);
  CHECK(steepest > 5);
  // The second derivative is bounded, by about (8 / 0.3)^2 times a few.
  CHECK(jump < 5000 * step);
}
