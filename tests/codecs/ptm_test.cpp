// What is special about `ptm`: biquadratics come back, and below zero they are zero.

#include <catch2/catch.hpp>
#include <cmath>

#include "codecs/sample_error.h"
#include "tests/codecs/synthetic_btf.h"

using namespace weft;

namespace {

std::unique_ptr<Representation> fit(const std::shared_ptr<const Btf>& btf,
                                    const std::vector<std::string>& parameters) {
  Progress progress;
  return codec_named("ptm").fit(btf, Settings::from_text("", "test", parameters), progress);
}

float biquadratic(const Direction& l, float x2, float y2, float xy, float x, float y, float c) {
  return x2 * l.x * l.x + y2 * l.y * l.y + xy * l.x * l.y + x * l.x + y * l.y + c;
}

Direction between(int i) {
  return from_spherical(radians(85 * std::fmod(0.618 * i, 1.0)),
                        radians(360 * std::fmod(0.755 * i, 1.0)));
}

}  // namespace

TEST_CASE("Biquadratics of the light come back, inside the cosine and outside") {
  const Direction up(0, 0, 1);
  for (const bool outside : {true, false}) {
    const auto value = [&](const Direction& l, int channel) {
      return biquadratic(l, 0.2F, -0.3F, 0.1F, 0.4F * static_cast<float>(channel), 0.2F, 1) *
             (outside ? l.z : 1);
    };
    const auto btf = synthetic_btf(2, 1, "ubo81", "regular:2x3",
                                   [&](int, int, const Direction& l, const Direction&) {
                                     return Rgb(value(l, 0), value(l, 1), value(l, 2)) / l.z;
                                   });
    const auto fitted =
        fit(btf, {"colour=channels", "bits=float", outside ? "cosine=outside" : "cosine=inside"});
    CHECK(sample_error(*btf, *fitted).relative_rmse < 1e-5);
    for (int i = 0; i < 100; ++i) {
      const Rgb found = fitted->evaluate({0.3F, 0.4F}, between(i), up, 0);
      for (int c = 0; c < 3; ++c) CHECK(found[c] == Approx(value(between(i), c)).margin(1e-5));
    }
  }
}

TEST_CASE(
    "A Lambert surface is exact with the cosine outside, and 7 % off where a polynomial is all") {
  const auto btf = synthetic_btf(
      2, 1, "ubo81", "regular:2x3",
      [](int, int, const Direction&, const Direction&) { return Rgb(0.3F, 0.2F, 0.1F); });
  CHECK(sample_error(*btf, *fit(btf, {})).relative_rmse < 1e-3);
  // That of the nearest biquadratic to sqrt(1 - x^2 - y^2) at these lights.
  CHECK(sample_error(*btf, *fit(btf, {"cosine=inside"})).relative_rmse ==
        Approx(0.07).margin(0.01));
}

TEST_CASE("One colour for all lights costs nothing where there is one") {
  const auto btf = synthetic_btf(2, 1, "ubo81", "regular:2x3",
                                 [](int x, int, const Direction& l, const Direction&) {
                                   return Rgb(0.9F, 0.2F, 0.5F + 0.3F * static_cast<float>(x)) *
                                          biquadratic(l, 0.2F, -0.3F, 0.1F, 0.4F, 0.2F, 1);
                                 });
  CHECK(sample_error(*btf, *fit(btf, {"bits=float"})).relative_rmse < 1e-5);
  CHECK(sample_error(*btf, *fit(btf, {})).relative_rmse < 1e-3);
}

TEST_CASE("Below zero a polynomial is zero") {
  const auto btf = synthetic_btf(
      1, 1, "ubo81", "regular:2x3",
      [](int, int, const Direction& l, const Direction&) { return Rgb(l.x > 0 ? 1.F : 0.F); });
  for (const std::string colour : {"average", "channels"}) {
    const auto fitted = fit(btf, {"colour=" + colour});
    int zeros = 0;
    for (int i = 0; i < 200; ++i) {
      const Rgb value = fitted->evaluate({0.5F, 0.5F}, between(i), Direction(0, 0, 1), 0);
      CHECK(value.x >= 0);
      zeros += value.x == 0 ? 1 : 0;
    }
    CHECK(zeros > 20);
  }
}
