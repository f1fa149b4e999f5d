// Parabolic maps, the half / difference parameterisation, and the linear operators made of them.

#include "codecs/factor_maps/parabolic_map.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "codecs/cmf/low_rank.h"
#include "codecs/factor_maps/half_difference.h"
#include "codecs/factor_maps/sample_map.h"

using namespace weft;
using namespace weft::cmf;
using namespace weft::factor_maps;

namespace {

float looked_up(const LaneVector& map, const BilinearTaps& taps, int lane) {
  float sum = 0;
  for (std::size_t k = 0; k < 4; ++k) sum += taps.weight[k] * map[taps.index[k]][lane];
  return sum;
}

}  // namespace

TEST_CASE("Every direction down to the horizon has four texels of the map") {
  for (const int resolution : {2, 3, 32, 33}) {
    const ParabolicMap map(resolution);
    for (int i = 0; i < 3000; ++i) {
      const double theta = i % 3 == 0 ? radians(89.9) : std::acos(std::fmod(i * 0.618, 1.0));
      const Direction d = from_spherical(theta, i * 2.4);
      const BilinearTaps taps = map.taps(d);
      Vec2 p(0, 0);
      float sum = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        REQUIRE(taps.index[k] < static_cast<std::uint32_t>(map.texels()));
        REQUIRE(taps.weight[k] >= 0);
        const float x = static_cast<float>(taps.index[k] % resolution);
        const float y = static_cast<float>(taps.index[k] / resolution);
        p += Vec2(x, y) * taps.weight[k];
        sum += taps.weight[k];
      }
      REQUIRE(sum == Approx(1));
      const auto last = static_cast<float>(resolution - 1);
      REQUIRE((Vec2(2 * p.x / last - 1, 1 - 2 * p.y / last) - parabolic(d)).length() < 1e-5F);
    }
  }
}

TEST_CASE("A NaN has texels of the map") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const ParabolicMap map(5);
  for (const std::uint32_t index : map.taps(Direction(nan, nan, 1)).index) {
    CHECK(index < static_cast<std::uint32_t>(map.texels()));
  }
}

TEST_CASE("A texel's direction is where the map looks itself up") {
  const ParabolicMap map(17);
  for (int texel = 0; texel < map.texels(); ++texel) {
    const Direction d = map.direction(texel);
    REQUIRE(d.length() == Approx(1));
    REQUIRE(d.z >= 0);
    if (!(d.z > 1e-3F)) continue;  // beyond the disc: the horizon's
    const BilinearTaps taps = map.taps(d);
    float own = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (taps.index[k] == static_cast<std::uint32_t>(texel)) own += taps.weight[k];
    }
    REQUIRE(own == Approx(1).margin(1e-3));
  }
}

TEST_CASE("A half-vector and a difference give the pair that has them") {
  for (int i = 0; i < 500; ++i) {
    const Direction half = from_spherical(std::fmod(i * 0.37, 1.5), i * 1.7);
    const Direction difference = from_spherical(std::fmod(i * 0.73, 1.55), i * 0.9);
    const DirectionPair pair = pair_of(half, difference);
    REQUIRE((half_vector(pair.light, pair.view) - half).length() < 1e-4F);
    REQUIRE((pair.light ^ half) == Approx(difference.z).margin(1e-5));
    // Turning the difference by 180 degrees swaps light and view.
    const DirectionPair swapped =
        pair_of(half, Direction(-difference.x, -difference.y, difference.z));
    REQUIRE((swapped.light - pair.view).length() < 1e-5F);
  }
}

TEST_CASE("Averaging over differences keeps a constant") {
  const HemisphereSampling sampling(named_directions("ubo81"));
  const ParabolicMap map(16);
  const SparseRows average = half_average(sampling, sampling, map, 6);
  LaneVector f(81 * 81);
  for (Lanes& pair : f) {
    for (int k = 0; k < lane_count; ++k) pair[k] = static_cast<float>(k + 1);
  }
  for (const Lanes& texel : multiply(average, f)) {
    for (int k = 0; k < lane_count; ++k) REQUIRE(texel[k] == Approx(k + 1).epsilon(1e-5));
  }
}

TEST_CASE("A map made from samples returns the samples") {
  for (const char* name : {"ubo81", "ubo151", "regular:4x9", "fibonacci:1", "fibonacci:2"}) {
    const HemisphereSampling sampling(named_directions(name));
    const SampleMap maker(sampling, ParabolicMap(32));
    LaneVector samples(sampling.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      for (int k = 0; k < lane_count; ++k) {
        samples[i][k] =
            1 + 0.9F * std::sin(static_cast<float>(k) + 2 * sampling[i].x + sampling[i].y * k / 10);
      }
    }
    const LaneVector map = maker.map_of(samples);
    INFO(name);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      for (int k = 0; k < lane_count; ++k) {
        REQUIRE(looked_up(map, maker.taps()[i], k) == Approx(samples[i][k]).margin(1e-4));
      }
    }
    for (const Lanes& texel : map) {
      for (int k = 0; k < lane_count; ++k) REQUIRE(texel[k] >= 0);
    }
  }
}

TEST_CASE("The rank-one step finds the product, and the first singular value of what is none") {
  constexpr std::size_t n_lights = 7;
  constexpr std::size_t n_views = 5;
  LaneVector f(n_lights * n_views);
  for (std::size_t i = 0; i < n_lights; ++i) {
    for (std::size_t j = 0; j < n_views; ++j) {
      for (int k = 0; k < lane_count; ++k) {
        const auto product = static_cast<float>((i + 1.0) * (j + 0.5 * k));
        // Lane 0 is a diagonal with a largest entry of 3 at (1, 1); lane 1 is black.
        f[i * n_views + j][k] = k == 0   ? (i == j ? (i == 1 ? 3.0F : 1.0F) : 0.0F)
                                : k == 1 ? 0.0F
                                         : product;
      }
    }
  }
  const LightView factors = rank_one(f, n_lights, n_views);
  for (std::size_t i = 0; i < n_lights; ++i) {
    for (std::size_t j = 0; j < n_views; ++j) {
      CHECK(factors.light[i][0] * factors.view[j][0] ==
            Approx(i == 1 && j == 1 ? 3 : 0).margin(1e-6));
      CHECK(factors.light[i][1] * factors.view[j][1] == 0);
      for (int k = 2; k < lane_count; ++k) {
        const double product = static_cast<double>(factors.light[i][k]) * factors.view[j][k];
        CHECK(product == Approx(f[i * n_views + j][k]).epsilon(1e-5));
      }
    }
  }
}
