// The error metrics against answers worked out by hand.
#include "study/metrics.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "btf/error.h"

namespace {

using Catch::Matchers::Contains;
using weft::Image;

Image constant(int width, int height, float value, int channels = 3) {
  Image image(width, height, channels);
  std::fill(image.values.begin(), image.values.end(), value);
  return image;
}

/// Structure at several scales, in [0, 1].
Image pattern(int width, int height) {
  Image image(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float v = 0.5F + 0.25F * std::sin(0.7F * x) * std::cos(0.4F * y) +
                      0.25F * std::sin(0.11F * (x + y));
      image.set_rgb(x, y, {v, 0.5F * v, 1 - v});
    }
  }
  return image;
}

std::string message_of(const Image& a, const Image& b) {
  try {
    weft::compare_images(a, b, "ref.exr", "test.exr");
  } catch (const weft::Error& error) {
    CHECK(error.kind() == weft::Error::Kind::bad_input);
    return error.what();
  }
  return {};
}

/// SSIM of one window written as the paper's sums, with two-dimensional weights.
double ssim_of_window(const Image& a, const Image& b, int cx, int cy, double range) {
  double weight = 0;
  double ma = 0;
  double mb = 0;
  for (int pass = 0; pass < 1; ++pass) {
    for (int j = -5; j <= 5; ++j) {
      for (int i = -5; i <= 5; ++i) {
        const double w = std::exp(-(i * i + j * j) / 4.5);
        weight += w;
        ma += w * a.values[a.offset(cx + i, cy + j)];
        mb += w * b.values[b.offset(cx + i, cy + j)];
      }
    }
  }
  ma /= weight;
  mb /= weight;
  double va = 0;
  double vb = 0;
  double cab = 0;
  for (int j = -5; j <= 5; ++j) {
    for (int i = -5; i <= 5; ++i) {
      const double w = std::exp(-(i * i + j * j) / 4.5) / weight;
      const double da = a.values[a.offset(cx + i, cy + j)] - ma;
      const double db = b.values[b.offset(cx + i, cy + j)] - mb;
      va += w * da * da;
      vb += w * db * db;
      cab += w * da * db;
    }
  }
  const double c1 = 1e-4 * range * range;
  const double c2 = 9e-4 * range * range;
  return (2 * ma * mb + c1) * (2 * cab + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
}

}  // namespace

TEST_CASE("Equal pictures have no error, SSIM 1 and an infinite PSNR") {
  const weft::ImageDifference d = weft::compare_images(pattern(40, 30), pattern(40, 30));
  CHECK(d.rmse == 0);
  CHECK(d.mae == 0);
  CHECK(d.relative_rmse == 0);
  CHECK(d.largest == 0);
  CHECK(std::isinf(d.psnr));
  CHECK(d.ssim == Approx(1).epsilon(1e-12));
}

TEST_CASE("One wrong value gives the errors worked out by hand") {
  const Image reference = constant(4, 5, 2.0F);
  Image test = reference;
  test.values[test.offset(3, 1) + 2] = 5.0F;  // off by 3, one of 60 values
  const weft::ImageDifference d = weft::compare_images(reference, test);
  CHECK(d.mae == Approx(3.0 / 60));
  CHECK(d.rmse == Approx(std::sqrt(9.0 / 60)));
  CHECK(d.relative_rmse == Approx(std::sqrt(9.0 / 60) / 2));
  CHECK(d.peak == 2);
  CHECK(d.psnr == Approx(20 * std::log10(2 / std::sqrt(9.0 / 60))));
  CHECK(d.largest == 3);
  CHECK(d.largest_x == 3);
  CHECK(d.largest_y == 1);
  CHECK(d.largest_channel == 2);
  CHECK(weft::error_per_pixel(reference, test).values[5 + 2] == Approx(1.0));
}

TEST_CASE("Sums do not lose small errors in large pictures") {
  const weft::ImageDifference d =
      weft::compare_images(constant(1500, 1500, 1000.0F), constant(1500, 1500, 1000.0625F));
  CHECK(d.rmse == Approx(0.0625).epsilon(1e-12));
  CHECK(d.mae == Approx(0.0625).epsilon(1e-12));
}

TEST_CASE("SSIM agrees with the paper's sums window by window") {
  Image a(13, 12, 1);
  Image b(13, 12, 1);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 13; ++x) {
      a.values[a.offset(x, y)] = 0.5F + 0.5F * std::sin(0.9F * x + 0.3F * y);
      b.values[b.offset(x, y)] = 0.4F + 0.3F * std::sin(0.8F * x + 0.5F * y);
    }
  }
  double sum = 0;
  for (int cy = 5; cy < 7; ++cy) {
    for (int cx = 5; cx < 8; ++cx) sum += ssim_of_window(a, b, cx, cy, 1.0);
  }
  CHECK(weft::mean_ssim(a, b, 1.0) == Approx(sum / 6).epsilon(1e-9));
}

TEST_CASE("SSIM of two flat pictures is the luminance term alone") {
  const Image a = constant(20, 20, 0.5F, 1);
  const Image b = constant(20, 20, 0.6F, 1);
  const double expected = (2 * 0.5 * 0.6 + 1e-4) / (0.25 + 0.36 + 1e-4);
  CHECK(weft::mean_ssim(a, b, 1.0) == Approx(expected).epsilon(1e-6));
}

TEST_CASE("SSIM does not change with exposure, and is below 1 for a negative picture") {
  const Image a = pattern(40, 30);
  Image b = a;
  for (std::size_t i = 0; i < b.values.size(); i += 7) b.values[i] += 0.1F;
  Image bright_a = a;
  Image bright_b = b;
  for (float& v : bright_a.values) v *= 1000;
  for (float& v : bright_b.values) v *= 1000;
  const double ssim = weft::compare_images(a, b).ssim;
  CHECK(ssim < 0.99);
  CHECK(weft::compare_images(bright_a, bright_b).ssim == Approx(ssim).epsilon(1e-5));
}

TEST_CASE("Pictures smaller than the window, and black ones, have an SSIM") {
  for (const auto& [w, h] : {std::pair{1, 1}, {10, 3}, {11, 2}, {3, 40}}) {
    CHECK(weft::compare_images(pattern(w, h), pattern(w, h)).ssim == Approx(1));
    const double other = weft::compare_images(pattern(w, h), constant(w, h, 0.1F)).ssim;
    CHECK(other < 0.95);
  }
  CHECK(weft::compare_images(constant(20, 20, 0), constant(20, 20, 0)).ssim == 1);
  const weft::ImageDifference d = weft::compare_images(constant(20, 20, 0), constant(20, 20, 1));
  CHECK(d.ssim == 0);
  CHECK(std::isinf(d.relative_rmse));
}

TEST_CASE("Sizes that differ, and values that are not finite, are refused by name") {
  CHECK_THAT(message_of(constant(4, 5, 1), constant(5, 4, 1)),
             Contains("test.exr") && Contains("5 x 4") && Contains("4 x 5"));
  CHECK_THAT(message_of(constant(4, 5, 1), constant(4, 5, 1, 1)), Contains("channels"));
  Image bad = constant(4, 5, 1);
  bad.values[bad.offset(2, 3) + 1] = std::numeric_limits<float>::quiet_NaN();
  bad.values[bad.offset(3, 4)] = std::numeric_limits<float>::infinity();
  CHECK_THAT(message_of(bad, constant(4, 5, 1)),
             Contains("ref.exr: 2 values") && Contains("x 2, y 3, green"));
  CHECK_THAT(message_of(constant(4, 5, 1), bad), Contains("test.exr: 2 values"));
}

TEST_CASE("Alpha is left out") {
  Image a = constant(4, 4, 1, 4);
  Image b = a;
  for (std::size_t i = 3; i < b.values.size(); i += 4) b.values[i] = 0;
  CHECK(weft::compare_images(a, b).rmse == 0);
}
