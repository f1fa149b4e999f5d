// Interpolation of raw BTFs, their mip chain, and Lambert's exactness.
#include "btf/raw_appearance.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "btf/random.h"

using namespace weft;

namespace {

constexpr float pi = std::numbers::pi_v<float>;

std::shared_ptr<Btf> lambert(int width, int height, PixelType type) {
  const HemisphereSampling ubo(named_directions("ubo81"));
  auto btf = std::make_shared<Btf>(width, height, ubo, ubo, type);
  for (std::size_t v = 0; v < ubo.size(); ++v) {
    for (std::size_t l = 0; l < ubo.size(); ++l) {
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          btf->set(l, v, x, y, Rgb(0.8F, 0.4F, 0.1F) * (ubo[l].z / pi));
        }
      }
    }
  }
  return btf;
}

}  // namespace

TEST_CASE("a Lambert table is exact between and beyond the samples") {
  const RawAppearance appearance(lambert(3, 2, PixelType::float32));
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const auto u = [&](int k) { return unit_float(hash_coordinates(i, k)); };
    const Direction light = from_spherical(radians(89.0F * u(0)), 2 * pi * u(1));
    const Direction view = from_spherical(radians(89.0F * u(2)), 2 * pi * u(3));
    const Rgb value = appearance.evaluate({4 * u(4) - 2, u(5)}, light, view, 2 * u(6));
    REQUIRE(value.x == Approx(0.8F / pi * light.z).epsilon(1e-4));
    REQUIRE(value.z == Approx(0.1F / pi * light.z).epsilon(1e-4));
  }
}

TEST_CASE("below the horizon the answer is zero") {
  const RawAppearance appearance(lambert(1, 1, PixelType::half));
  const Direction up(0, 0, 1);
  const Direction level(1, 0, 0);
  const Direction down = from_spherical(2, 0);
  CHECK(appearance.evaluate({0, 0}, level, up, 0) == Rgb(0, 0, 0));
  CHECK(appearance.evaluate({0, 0}, up, down, 0) == Rgb(0, 0, 0));
  CHECK(appearance.evaluate({0, 0}, down, up, 0) == Rgb(0, 0, 0));
}

TEST_CASE("texels: row 0 is at v near 1, centres are exact, uv repeats") {
  auto btf = std::make_shared<Btf>(4, 3, HemisphereSampling({{0, 0, 1}}),
                                   HemisphereSampling({{0, 0, 1}}), PixelType::float32);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x)
      btf->set(0, 0, x, y, Rgb(static_cast<float>(x), static_cast<float>(y), 1));
  }
  const RawAppearance appearance(btf);
  const Direction up(0, 0, 1);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x) {
      for (const float turn : {-2.0F, 0.0F, 3.0F}) {
        const Texcoord uv((x + 0.5F) / 4 + turn, 1 - (y + 0.5F) / 3 - turn);
        const Rgb value = appearance.evaluate(uv, up, up, 0);
        CHECK(value.x == Approx(x).margin(1e-4));
        CHECK(value.y == Approx(y).margin(1e-4));
      }
    }
  }
  // Half way between the last and the first column, which are neighbours.
  CHECK(appearance.evaluate({0, 0.5F}, up, up, 0).x == Approx(1.5));
}

TEST_CASE("mip levels are area means, odd sizes too") {
  auto btf = std::make_shared<Btf>(5, 3, HemisphereSampling({{0, 0, 1}}),
                                   HemisphereSampling({{0, 0, 1}}), PixelType::float32);
  double sum = 0;
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) {
      const float value = unit_float(hash_coordinates(x, y));
      btf->set(0, 0, x, y, Rgb(value));
      sum += value;
    }
  }
  const RawAppearance appearance(btf);
  REQUIRE(appearance.levels().size() == 3);
  CHECK(appearance.levels()[1]->width() == 2);
  CHECK(appearance.levels()[1]->height() == 1);
  const Direction up(0, 0, 1);
  CHECK(appearance.evaluate({0.3F, 0.7F}, up, up, 10).x == Approx(sum / 15));
  const float middle = appearance.evaluate({0.25F, 0.5F}, up, up, 1).x;
  const float top = appearance.evaluate({0.25F, 0.5F}, up, up, 2).x;
  CHECK(appearance.evaluate({0.25F, 0.5F}, up, up, 1.25F).x ==
        Approx(0.75F * middle + 0.25F * top));
}

TEST_CASE("NaN and infinity as uv or level are answered from within the data") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const Texcoord& uv : {Texcoord(nan, 0), Texcoord(0, nan), Texcoord(infinity, -infinity),
                             Texcoord(-1e-9F, -1e-9F)}) {
    const TexelStencil texels = bilinear_texels(uv, 5, 3);
    for (const std::uint32_t index : texels.index) CHECK(index < 15);
  }
  const RawAppearance appearance(lambert(5, 3, PixelType::half));
  const Direction up(0, 0, 1);
  CHECK(std::isnan(appearance.evaluate({nan, 0}, up, up, 0).x));
  CHECK(appearance.evaluate({0, 0}, up, up, nan) == appearance.evaluate({0, 0}, up, up, 0));
}
