// Codebooks improved against the data, and the least squares of one map that they are made by.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "codecs/factor_maps/map_equations.h"
#include "codecs/representation.h"
#include "codecs/sample_error.h"
#include "tests/codecs/synthetic_btf.h"

using namespace weft;
using factor_maps::BilinearTaps;
using factor_maps::MapEquations;
using factor_maps::ParabolicMap;

namespace {

double cmf_error(const std::shared_ptr<const Btf>& btf,
                 const std::vector<std::string>& parameters) {
  Progress progress;
  const auto fitted =
      codec_named("cmf").fit(btf, Settings::from_text("", "test", parameters), progress);
  return sample_error(*btf, *fitted).relative_rmse;
}

double lookup(const std::vector<double>& map, const BilinearTaps& taps) {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) sum += taps.weight[k] * map[taps.index[k]];
  return sum;
}

}  // namespace

TEST_CASE("A map's equations return what many sites ask, and spread what few do") {
  constexpr int resolution = 12;
  const ParabolicMap map(resolution);
  const std::vector<double> start(144, 2.0);
  for (const int count : {1, 20, 2000}) {
    MapEquations equations(resolution, 1e-4);
    std::vector<BilinearTaps> sites;
    std::vector<double> wanted;
    for (int i = 0; i < count; ++i) {
      const Direction d = from_spherical(std::acos(std::fmod(0.9 + i * 0.618, 1.0)), i * 2.4);
      sites.push_back(map.taps(d));
      // What a map can return: bilinear in its own plane.
      const Vec2 p = parabolic(d);
      wanted.push_back(3 + p.x - 0.5 * p.y);
      const double weight = 1 + i % 3;
      equations.add(sites.back(), weight, weight * (wanted.back() - lookup(start, sites.back())));
    }
    const std::vector<double> solved = equations.solved(start);
    for (std::size_t i = 0; i < sites.size(); ++i) {
      INFO(count << " sites");
      REQUIRE(lookup(solved, sites[i]) == Approx(wanted[i]).margin(0.02));
    }
    // One site, that asks for 1.2 more, moves the whole map.
    if (count == 1) {
      CHECK(std::ranges::min(solved) > 2.5);
      CHECK(std::ranges::max(solved) < 5);
    }
  }
}

TEST_CASE("A map's equations keep it above zero, and never make it worse") {
  constexpr int resolution = 8;
  const ParabolicMap map(resolution);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<double> start(64);
    for (std::size_t i = 0; i < start.size(); ++i)
      start[i] = std::max(std::sin(static_cast<double>(i * (trial + 1))), 0.0);
    MapEquations equations(resolution, 1e-4);
    std::vector<BilinearTaps> sites;
    std::vector<double> wanted;
    for (int i = 0; i < 60; ++i) {
      sites.push_back(map.taps(from_spherical(std::acos(std::fmod(i * 0.618, 1.0)), i * 2.4)));
      wanted.push_back(std::max(std::cos(static_cast<double>(i * i + trial)), 0.0));
      equations.add(sites.back(), 1, wanted.back() - lookup(start, sites.back()));
    }
    const auto error = [&](const std::vector<double>& values) {
      double sum = 0;
      for (std::size_t i = 0; i < sites.size(); ++i)
        sum += std::pow(lookup(values, sites[i]) - wanted[i], 2);
      return sum;
    };
    const std::vector<double> solved = equations.solved(start);
    CHECK(std::ranges::min(solved) >= 0);
    CHECK(error(solved) < 0.75 * error(start));  // the rest is below zero, or noise
  }
  const std::vector<double> start(64, 0.25);
  CHECK(MapEquations(resolution, 1e-4).solved(start) == start);
}

TEST_CASE("A site that hardly weighs does not move a smooth map far") {
  constexpr int resolution = 8;
  const ParabolicMap map(resolution);
  const std::vector<double> start(64, 1.0);
  const BilinearTaps noisy = map.taps(Direction(0, 0, 1));
  const auto moved = [&](double smoothness) {
    MapEquations equations(resolution, smoothness);
    for (int i = 0; i < 60; ++i) {
      const Direction d = from_spherical(1.0, i * 0.1);
      equations.add(map.taps(d), 1, 0);
    }
    equations.add(noisy, 1e-2, 1e-2 * 100);
    return lookup(equations.solved(start), noisy) - 1;
  };
  CHECK(moved(1e-6) > 80);
  CHECK(moved(1) < 5);
}

TEST_CASE("Refined codebooks lose less, for every set of factors, with mip levels and turned",
          "[heavy]") {
  const auto btf = realistic_btf(16, "regular:4x8");
  for (const std::string factors :
       {"light,view", "light,half,view", "light,half,difference,view"}) {
    for (const std::string rotate : {"false", "true"}) {
      std::vector<std::string> parameters{"factors=" + factors, "rotate=" + rotate, "clusters=8",
                                          "refine_codebooks=0"};
      const double before = cmf_error(btf, parameters);
      parameters.back() = "refine_codebooks=1";
      const double once = cmf_error(btf, parameters);
      parameters.back() = "refine_codebooks=4";
      const double often = cmf_error(btf, parameters);
      INFO(factors << ", rotate=" << rotate << ": " << before << ", " << once << ", " << often);
      CHECK(once < (factors == "light,view" ? 0.99 : 0.9) * before);
      CHECK(often < once);
    }
  }
}
