// The four views of two rings: weights that sum to one, answer a sampled direction by itself, and
// vary continuously; other samplings are answered by their triangulation.

#include "codecs/ring_stencil.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

using namespace weft;

namespace {

HemisphereSampling named(const std::string& name) {
  return HemisphereSampling(named_directions(name));
}

DirectionLanes sixteen_of(const Direction& direction) {
  DirectionLanes lanes;
  lanes.x.fill(direction.x);
  lanes.y.fill(direction.y);
  lanes.z.fill(direction.z);
  return lanes;
}

// Weight of each direction; those of several entries are added.
std::map<int, float> weights(const HemisphereSampling& sampling, const RingStencil& rings,
                             const Direction& direction) {
  const StencilLane stencil = rings.locate(sampling, direction);
  std::map<int, float> sum;
  for (std::size_t k = 0; k < 4; ++k) sum[stencil.index[k]] += stencil.weight[k];
  return sum;
}

float difference(const std::map<int, float>& a, const std::map<int, float>& b) {
  float sum = 0;
  for (const auto& [index, weight] : a)
    sum += std::abs(weight - (b.contains(index) ? b.at(index) : 0));
  for (const auto& [index, weight] : b) sum += a.contains(index) ? 0 : weight;
  return sum;
}

}  // namespace

TEST_CASE("ubo81 and ubo151 lie in rings, but regular, fibonacci and faded samplings do not") {
  CHECK(RingStencil(named("ubo81")).has_rings());
  CHECK(RingStencil(named("ubo151")).has_rings());
  for (const std::string name : {"regular:3x6", "fibonacci:40", "fibonacci:1"})
    CHECK(!RingStencil(named(name)).has_rings());
  CHECK(!RingStencil(HemisphereSampling(named_directions("ubo81"), Horizon::fade)).has_rings());
}

TEST_CASE("A sampled view is answered by itself") {
  for (const std::string name : {"ubo81", "ubo151", "regular:4x7"}) {
    const HemisphereSampling sampling = named(name);
    const RingStencil rings(sampling);
    for (std::size_t i = 0; i < sampling.size(); ++i)
      CHECK(weights(sampling, rings, sampling[i])[static_cast<int>(i)] == Approx(1).margin(2e-5));
  }
}

TEST_CASE("Ring weights sum to one, and interpolate theta and phi bilinearly") {
  for (const std::string name : {"ubo81", "ubo151"}) {
    const HemisphereSampling sampling = named(name);
    const RingStencil rings(sampling);
    for (int i = 0; i < 2000; ++i) {
      const double theta = radians(90 * std::fmod(0.618 * i, 1.0));
      const double phi = radians(360 * std::fmod(0.755 * i, 1.0));
      const StencilLane s = rings.locate(sampling, from_spherical(theta, phi));
      double sum = 0;
      double mean_theta = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        CHECK(s.weight[k] >= 0);
        sum += s.weight[k];
        mean_theta += s.weight[k] * theta_of(sampling[s.index[k]]);
      }
      CHECK(sum == Approx(1).margin(1e-6));
      CHECK(mean_theta == Approx(std::min(theta, radians(75.0))).margin(1e-5));
    }
  }
}

TEST_CASE("A direction by itself stands where it does among sixteen, on axes and zeros too") {
  for (const std::string name : {"ubo81", "ubo151"}) {
    const HemisphereSampling sampling = named(name);
    const RingStencil rings(sampling);
    std::vector<Direction> asked = {{0, 0, 1}, {-0.0F, -0.0F, 1}, {0, -0.0F, 1}};
    for (const float a : {0.0F, -0.0F, 0.6F, -0.6F}) {
      for (const float b : {0.0F, -0.0F, 0.8F, -0.8F}) {
        const float square = a * a + b * b;
        asked.emplace_back(a, b, std::sqrt(std::max(0.0F, 1 - square)));
        asked.emplace_back(b, a, std::sqrt(std::max(0.0F, 1 - square)));
      }
    }
    for (int i = 0; i < 4000; ++i)
      asked.push_back(from_spherical(radians(90 * std::fmod(0.618 * i, 1.0)),
                                     radians(360 * std::fmod(0.755 * i, 1.0))));
    for (const Direction& sampled : sampling.directions()) asked.push_back(sampled);
    for (const Direction& d : asked) {
      INFO(name << ": " << d.x << ' ' << d.y << ' ' << d.z);
      const DirectionLanes lanes = sixteen_of(d);
      const StencilLane among = rings.locate(sampling, lanes)[7];
      std::map<int, float> sum;
      for (std::size_t k = 0; k < 4; ++k) sum[among.index[k]] += among.weight[k];
      CHECK(difference(sum, weights(sampling, rings, d)) < 1e-5F);
    }
    // Whatever is no number stands among the views.
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const Direction& none : {Direction(nan, nan, nan), Direction(nan, 0.6F, 0.8F),
                                  Direction(0.6F, nan, 0.8F), Direction(0.6F, 0.8F, nan)}) {
      const DirectionLanes lanes = sixteen_of(none);
      for (const StencilLane& nowhere :
           {rings.locate(sampling, none), StencilLane(rings.locate(sampling, lanes)[3])}) {
        for (std::size_t k = 0; k < 4; ++k) {
          CHECK(nowhere.index[k] >= 0);
          CHECK(nowhere.index[k] < static_cast<int>(sampling.size()));
        }
      }
    }
  }
}

TEST_CASE("From 2 to 32 rings, theta and phi are those that were asked for") {
  for (const int count : {2, 3, 5, 16, 17, 18, 31, 32, 33}) {
    std::vector<Direction> directions{{0, 0, 1}};
    for (int ring = 1; ring < count; ++ring) {
      for (int k = 0; k < 4 + ring % 3; ++k) {
        const double turn = 2 * std::numbers::pi * (k + 0.2) / (4 + ring % 3);
        directions.push_back(from_spherical(radians(80.0) * ring / (count - 1), turn));
      }
    }
    const HemisphereSampling sampling(directions);
    const RingStencil rings(sampling);
    INFO(count << " rings");
    REQUIRE(rings.has_rings() == (count <= 32));
    if (!rings.has_rings()) continue;
    for (int i = 0; i < 3000; ++i) {
      const double theta = radians(80 * std::fmod(0.618 * i, 1.0));
      const Direction asked = from_spherical(theta, radians(360 * std::fmod(0.755 * i, 1.0)));
      const DirectionLanes lanes = sixteen_of(asked);
      for (const StencilLane& s :
           {rings.locate(sampling, asked), StencilLane(rings.locate(sampling, lanes)[12])}) {
        double found = 0;
        for (std::size_t k = 0; k < 4; ++k) found += s.weight[k] * theta_of(sampling[s.index[k]]);
        REQUIRE(found == Approx(theta).margin(1e-5));
        // Both of a ring are next to what was asked for.
        for (std::size_t k = 0; k < 4; k += 2) {
          if (s.index[k] == s.index[k + 1]) continue;  // the pole
          const double steps =
              2 * std::numbers::pi /
              std::remainder(phi_of(sampling[s.index[k + 1]]) - phi_of(sampling[s.index[k]]),
                             2 * std::numbers::pi);
          const double share =
              std::remainder(phi_of(asked) - phi_of(sampling[s.index[k]]), 2 * std::numbers::pi) *
              steps / (2 * std::numbers::pi);
          const double weight = s.weight[k] + s.weight[k + 1];
          REQUIRE(s.weight[k + 1] == Approx(share * weight).margin(1e-4));
        }
      }
    }
  }
}

TEST_CASE("Ring weights vary continuously across rings, spokes, the pole and the last ring") {
  const HemisphereSampling sampling = named("ubo81");
  const RingStencil rings(sampling);
  constexpr double step = radians(0.02);
  // Along meridians, through the pole; along circles, those of the rings too.
  for (int k = 0; k < 24; ++k) {
    const double phi = radians(15.0 * k + 0.1 * (k % 3));
    auto before = weights(sampling, rings, from_spherical(0, phi));
    for (double theta = 0; theta < radians(89.0); theta += step) {
      const auto here = weights(sampling, rings, from_spherical(theta, phi));
      CHECK(difference(here, before) < 0.01F);
      before = here;
    }
    const double circle = radians(3.75 * k);
    before = weights(sampling, rings, from_spherical(circle, 0));
    for (double turn = 0; turn < radians(361.0); turn += step) {
      const auto here = weights(sampling, rings, from_spherical(circle, turn));
      CHECK(difference(here, before) < 0.01F);
      before = here;
    }
  }
}

TEST_CASE("Where there are no rings the triangulation answers") {
  const HemisphereSampling sampling = named("fibonacci:40");
  const RingStencil rings(sampling);
  for (int i = 0; i < 200; ++i) {
    const Direction d = from_spherical(radians(90 * std::fmod(0.618 * i, 1.0)),
                                       radians(360 * std::fmod(0.755 * i, 1.0)));
    const Stencil expected = sampling.locate(d);
    std::map<int, float> sum;
    for (std::size_t k = 0; k < 3; ++k) sum[expected.index[k]] += expected.weight[k];
    CHECK(difference(sum, weights(sampling, rings, d)) < 1e-4F);
  }
}
