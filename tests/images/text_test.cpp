// Text leaves ink where it was asked to, and a missing font says what to install.
#include "images/text.h"

#include <catch2/catch.hpp>

#include "btf/error.h"

namespace {

using weft::Image;

struct Extent {
  int left = 1 << 20;
  int right = -1;
  int top = 1 << 20;
  int bottom = -1;
};

Extent ink_of(const Image& image) {
  Extent extent;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (image.rgb(x, y).x < 0.5F) continue;
      extent = {std::min(extent.left, x), std::max(extent.right, x), std::min(extent.top, y),
                std::max(extent.bottom, y)};
    }
  }
  return extent;
}

}  // namespace

TEST_CASE("Text is drawn where it is asked for and as wide as it says") {
  const int width = weft::text_width("0.25", 20);
  CHECK(width > 20);
  CHECK(width < 80);
  Image left(200, 60, 3);
  weft::draw_text(left, 50, 30, "0.25", 20, {1, 1, 1});
  const Extent ink = ink_of(left);
  CHECK(std::abs(ink.left - 50) <= 3);
  CHECK(std::abs(ink.right - (50 + width)) <= 3);
  CHECK(std::abs(0.5 * (ink.top + ink.bottom) - 30) <= 2);

  Image right(200, 60, 3);
  weft::draw_text(right, 150, 30, "0.25", 20, {1, 1, 1}, weft::TextAlignment::right);
  CHECK(std::abs(ink_of(right).right - 150) <= 3);
}

TEST_CASE("Text over the edge is cut") {
  Image image(20, 20, 3);
  weft::draw_text(image, 10, 2, "wide text", 20, {1, 1, 1});
  CHECK(ink_of(image).right == 19);
}

TEST_CASE("Text that would come out as other glyphs is refused") {
  Image image(20, 20, 3);
  CHECK_THROWS_AS(weft::draw_text(image, 1, 10, "\u2265 1", 20, {1, 1, 1}), weft::Error);
  CHECK_THROWS_AS(weft::text_width("\n", 20), weft::Error);
}
