// The colour scale is uniform and inside the gamut; the map has its legend.
#include "study/colour_map.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "btf/error.h"

namespace {

using weft::Image;
using weft::Rgb;
using weft::Vec3;

/// CIELAB lightness of a linear colour: a second opinion, from another model than the scale was
/// made with.
double cie_lightness(const Rgb& c) {
  const double y = 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
  return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
}

bool same(const Rgb& a, const Rgb& b) {
  return (a - b).length() < 1e-6F;
}

}  // namespace

TEST_CASE("OKLab of known colours") {
  const Vec3 white = weft::oklab({1, 1, 1});
  CHECK(white.x == Approx(1).margin(1e-4));
  CHECK(white.y == Approx(0).margin(1e-4));
  CHECK(white.z == Approx(0).margin(1e-4));
  const Vec3 red = weft::oklab({1, 0, 0});  // Ottosson 2020: L 0.628, a 0.225, b 0.126
  CHECK(red.x == Approx(0.628).margin(1e-3));
  CHECK(red.y == Approx(0.225).margin(1e-3));
  CHECK(red.z == Approx(0.126).margin(1e-3));
  const Rgb back = weft::linear_from_oklab(weft::oklab({0.3F, 0.5F, 0.1F}));
  CHECK((back - Rgb(0.3F, 0.5F, 0.1F)).length() < 1e-5F);
}

TEST_CASE("Equal steps of the scale are equal steps in OKLab, and all its colours can be shown") {
  constexpr int steps = 256;
  double least = 1;
  double most = 0;
  double lightness_before = 0;
  for (int i = 0; i <= steps; ++i) {
    const Rgb colour = weft::scale_colour(static_cast<double>(i) / steps);
    CHECK(std::min({colour.x, colour.y, colour.z}) >= 0);
    CHECK(weft::max_component(colour) <= 1);
    CHECK(cie_lightness(colour) > lightness_before);
    lightness_before = cie_lightness(colour);
    if (i == 0) continue;
    const Vec3 here = weft::oklab(colour);
    const Vec3 before = weft::oklab(weft::scale_colour(static_cast<double>(i - 1) / steps));
    const double distance = (here - before).length();
    least = std::min(least, distance);
    most = std::max(most, distance);
    CHECK(here.x - before.x == Approx(0.67 / steps).epsilon(0.02));
  }
  CHECK(most / least < 1.02);
}

TEST_CASE("Values outside the scale have the colours of its ends") {
  CHECK(same(weft::scale_colour(-1), weft::scale_colour(0)));
  CHECK(same(weft::scale_colour(7), weft::scale_colour(1)));
}

TEST_CASE("The scale ends at a round number above nearly all values") {
  Image values(100, 10, 1);
  CHECK(weft::scale_top(values) == 1);
  for (int i = 0; i < 1000; ++i) values.values[i] = 0.0003F * static_cast<float>(i) / 1000;
  CHECK(weft::scale_top(values) == Approx(0.0005));
  values.values[7] = 1000;  // one outlier
  CHECK(weft::scale_top(values) == Approx(0.0005));
  std::fill(values.values.begin(), values.values.end(), 0.2F);
  CHECK(weft::scale_top(values) == Approx(0.2));
}

TEST_CASE("A map shows its values, and beside them the whole scale with numbers") {
  Image values(60, 200, 1);
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 60; ++x) values.values[values.offset(x, y)] = static_cast<float>(x) / 59;
  }
  const Image map = weft::draw_colour_map(values, 1.0, "error");
  REQUIRE(map.height == 200);
  REQUIRE(map.width > 60 + 40);
  CHECK(same(map.rgb(0, 100), weft::scale_colour(0)));
  CHECK(same(map.rgb(59, 100), weft::scale_colour(1)));

  // Down the middle of the bar the scale runs from its top colour to its bottom colour.
  const int bar = 60 + 10 + 9;
  int top = 200;
  int bottom = 0;
  for (int y = 0; y < 200; ++y) {
    if ((map.rgb(bar, y) - weft::scale_colour(1)).length() < 0.05F) top = std::min(top, y);
    if ((map.rgb(bar, y) - weft::scale_colour(0)).length() < 0.01F) bottom = std::max(bottom, y);
  }
  CHECK(top < 50);
  CHECK(bottom > 180);
  // To its right stand numbers: dark ink on white.
  int ink = 0;
  for (int y = 0; y < 200; ++y) {
    for (int x = bar + 9 + 6; x < map.width; ++x) ink += map.rgb(x, y).x < 0.3F ? 1 : 0;
  }
  CHECK(ink > 100);
}

TEST_CASE("A map refuses what it cannot draw") {
  CHECK_THROWS_AS(weft::draw_colour_map(Image(4, 4, 3), 1, ""), weft::Error);
  CHECK_THROWS_AS(weft::draw_colour_map(Image(4, 4, 1), 0, ""), weft::Error);
  CHECK_THROWS_AS(weft::draw_colour_map(Image(4, 4, 1), NAN, ""), weft::Error);
}
