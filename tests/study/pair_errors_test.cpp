// Errors of each pair, against sums made by hand.
#include "study/pair_errors.h"

#include <catch2/catch.hpp>
#include <memory>

#include "btf/error.h"

namespace {

using weft::Btf;
using weft::Direction;
using weft::Rgb;

// The normal, two slanted directions, and one on the horizon.
weft::HemisphereSampling four_directions() {
  return weft::HemisphereSampling({{0, 0, 1},
                                   weft::from_spherical(weft::radians(40.0), 0),
                                   weft::from_spherical(weft::radians(40.0), weft::radians(120.0)),
                                   {0, 1, 0}});
}

std::shared_ptr<Btf> grey(float value) {
  auto btf =
      std::make_shared<Btf>(2, 2, four_directions(), four_directions(), weft::PixelType::float32);
  for (std::size_t v = 0; v < 4; ++v) {
    for (std::size_t l = 0; l < 4; ++l) {
      for (int t = 0; t < 4; ++t) btf->set(l, v, t % 2, t / 2, Rgb(value, value, value));
    }
  }
  return btf;
}

std::unique_ptr<weft::Representation> raw(std::shared_ptr<const Btf> btf) {
  weft::Progress silent;
  return weft::codec_named("raw").fit(std::move(btf), weft::Settings(), silent);
}

}  // namespace

TEST_CASE("A dataset has no error against itself") {
  const auto btf = grey(0.25F);
  const weft::PairErrors errors = weft::pair_errors(*btf, *raw(btf));
  CHECK(errors.pairs == 9);  // of 16: what lies on the horizon is left out
  for (const auto& channel : errors.channels) {
    CHECK(channel.mse.greatest < 1e-12);
    CHECK(channel.mae.greatest < 1e-6);
  }
}

TEST_CASE("Average, least and greatest error of Y, Cb and Cr are told over the pairs") {
  const auto btf = grey(0.25F);
  const auto changed = grey(0.25F);
  // Two of four texels of one pair: 0.4 more blue, 0.2 more red.
  changed->set(1, 2, 0, 0, Rgb(0.25F, 0.25F, 0.65F));
  changed->set(1, 2, 1, 1, Rgb(0.45F, 0.25F, 0.25F));
  const weft::PairErrors errors = weft::pair_errors(*btf, *raw(changed));
  const auto& [y, cb, cr] = errors.channels;
  const double y_blue = 0.114 * 0.4;
  const double y_red = 0.299 * 0.2;
  CHECK(y.mse.least == Approx(0).margin(1e-12));
  CHECK(y.mse.greatest == Approx((y_blue * y_blue + y_red * y_red) / 4).epsilon(1e-4));
  CHECK(y.mse.average == Approx(y.mse.greatest / 9).epsilon(1e-4));
  CHECK(y.mae.greatest == Approx((y_blue + y_red) / 4).epsilon(1e-4));
  // Cb = (B - Y) / 1.772, Cr = (R - Y) / 1.402.
  CHECK(cb.mae.greatest == Approx(((0.4 - y_blue) + y_red) / 1.772 / 4).epsilon(1e-4));
  CHECK(cr.mae.greatest == Approx((y_blue + (0.2 - y_red)) / 1.402 / 4).epsilon(1e-4));
  CHECK(cr.mae.average == Approx(cr.mae.greatest / 9).epsilon(1e-4));
}

TEST_CASE("Pair errors refuse a BTF of other texels, naming it") {
  const auto btf = grey(0.25F);
  const auto other =
      std::make_shared<Btf>(3, 2, four_directions(), four_directions(), weft::PixelType::float32);
  CHECK_THROWS_WITH(weft::pair_errors(*btf, *raw(other), "other.btf"),
                    Catch::Matchers::Contains("other.btf") && Catch::Matchers::Contains("3 x 2") &&
                        Catch::Matchers::Contains("2 x 2"));
}
