// Where an SRBF fit begins, with the angles where they are and moved by expectation and
// maximisation (paper 001, equations 3.9 to 3.11).

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "btf/random.h"
#include "codecs/srbf/angle_expectation.h"
#include "codecs/srbf/initial_guess.h"
#include "codecs/srbf/srbf_representation.h"
#include "tests/codecs/synthetic_btf.h"

using namespace weft;
using namespace weft::srbf;

namespace {

double random(std::uint64_t i, int what) {
  return 2.0 * unit_float(hash_coordinates(83, i, what)) - 1;
}

/// What some kernels have of some samples, as of a texel that is bright about a tilted half-way
/// vector.
struct SharedOut {
  std::vector<std::array<double, 3>> pull;
  std::vector<Direction> light;
  std::vector<Direction> view;
  AngleExpectation expectation;
};

SharedOut some_shares(std::uint64_t seed) {
  SharedOut shares;
  const std::vector<Direction> directions = named_directions("fibonacci:12");
  for (const Direction& light : directions) {
    for (const Direction& view : directions) {
      double pull[3];  // NOLINT
      for (int c = 0; c < 3; ++c)
        pull[c] = random(shares.pull.size(), static_cast<int>(3 * seed) + c);
      pull[2] += 1;
      shares.pull.push_back({pull[0], pull[1], pull[2]});
      shares.light.push_back(light);
      shares.view.push_back(view);
      shares.expectation.add(pull, light, view);
    }
  }
  return shares;
}

constexpr double half_way = std::numbers::pi / 4;

}  // namespace

TEST_CASE("SRBF: Q of a mode's angle is what equation 3.11 says, and does not fall in a round") {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const SharedOut shares = some_shares(seed);
    for (const double angle : {-half_way, 0.0, 0.3, half_way, 1.2, 2 * half_way}) {
      double q = 0;
      for (std::size_t i = 0; i < shares.pull.size(); ++i) {
        const Direction variable = psi(angle, shares.light[i], shares.view[i]);
        for (int c = 0; c < 3; ++c) q += shares.pull[i][c] * variable[c];
      }
      CHECK(shares.expectation(angle) == Approx(q).margin(2e-3));  // psi is of floats
      const double found = shares.expectation.best_near(angle);
      CHECK(shares.expectation(found) >= shares.expectation(angle));
      CHECK(std::abs(found - angle) <= std::numbers::pi / 8);
      // No angle on a grid of half a degree is better by more than the search leaves open.
      double best = shares.expectation(found);
      for (double t = angle - radians(22.0); t <= angle + radians(22.0); t += radians(0.5))
        best = std::max(best, shares.expectation(t));
      CHECK(shares.expectation(found) > best - 1e-6 * std::abs(best));
    }
  }
}

TEST_CASE("SRBF: angles that the guess moves run to the half-way vector, others stay") {
  const auto btf = realistic_btf(2, "regular:4x10");
  const Samples samples(btf->views(), btf->lights(), Quantity::radiance);
  for (int texel = 0; texel < 4; ++texel) {
    std::vector<float> abrdf(3 * samples.pairs);
    btf->abrdf(texel % 2, texel / 2, abrdf);
    const std::vector<float> channels = channel_arrays(samples, abrdf, 1);
    Modes modes = modes_named("optimal", 3, true);
    const auto angles = [&] {
      const Kernels guess = initial_guess(samples, channels, {8, 3}, modes, 1);
      for (const double number : guess.values()) CHECK(std::isfinite(number));
      return std::vector<double>(guess.angles().begin(), guess.angles().end());
    };
    CHECK(angles() == modes.angles);
    modes.em_angles = true;
    const std::vector<double> moved = angles();
    for (std::size_t k = 0; k < 3; ++k) {
      INFO("texel " << texel << ", mode " << k << " of " << moved[k]);
      CHECK(std::abs(moved[k] - half_way) < radians(15.0));
    }
  }
}

TEST_CASE("SRBF: bandwidths of the guess are at most 4, on data however peaked, from any samples") {
  // A mirror's peak, and one that two samples alone see: unheld, their lambda would grow without
  // end.
  const auto mirror = synthetic_btf(
      1, 1, "regular:4x10", "regular:4x10",
      [](int, int, const Direction& light, const Direction& view) {
        return Rgb(0.001F + 50 * std::pow(std::max((light + view).normalized().z, 0.0F), 2000.0F));
      });
  const auto two_pairs = synthetic_btf(1, 1, "regular:4x10", "regular:4x10",
                                       [](int, int, const Direction& light, const Direction& view) {
                                         return Rgb(light == view && light.x > 0.9F ? 1.0F : 0.0F);
                                       });
  for (const auto& btf : {realistic_btf(2, "regular:4x10"), mirror, two_pairs}) {
    const Samples samples(btf->views(), btf->lights(), Quantity::radiance);
    std::vector<float> abrdf(3 * samples.pairs);
    for (int texel = 0; texel < btf->width() * btf->height(); ++texel) {
      btf->abrdf(texel % btf->width(), texel / btf->width(), abrdf);
      const std::vector<float> channels = channel_arrays(samples, abrdf, 1);
      for (const bool em_angles : {false, true}) {
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
          Modes modes = modes_named("optimal", 3, true);
          modes.em_angles = em_angles;
          Kernels guess = initial_guess(samples, channels, {8, 3}, modes, seed);
          double largest = 0;
          for (std::size_t j = 0; j < 8; ++j) {
            for (std::size_t k = 0; k < 3; ++k) {
              const double* p = guess.centre(j, k);
              const double lambda = std::hypot(p[0], p[1], p[2]);
              REQUIRE(std::isfinite(lambda));
              CHECK(lambda <= 4 + 1e-5);  // directions are floats
              largest = std::max(largest, lambda);
            }
          }
          CHECK(largest > 0);
        }
      }
    }
  }
}

TEST_CASE("SRBF: a fit whose guess moves the angles ends well, and fixed angles are not moved") {
  const auto btf = realistic_btf(4, "regular:3x6");
  const auto fit_with = [&](std::vector<std::string> parameters) {
    parameters.insert(parameters.end(), {"kernels=6", "iterations=40"});
    Progress silent;
    const auto found =
        codec_named("srbf").fit(btf, Settings::from_text("", "test", parameters), silent);
    const Model& model = dynamic_cast<const SrbfRepresentation&>(*found).model();
    CHECK(silent.reported().at("texels_that_fell_back") == 0);
    for (const float value : model.values) REQUIRE(std::isfinite(value));
    return model;
  };
  const Model moved = fit_with({"em_angles=true"});
  const Model as_they_are = fit_with({"em_angles=false"});
  const bool same = moved.values == as_they_are.values;
  CHECK(!same);
  const auto error = [](const Model& model) {
    return nlohmann::json::parse(model.report)["levels"][0]["relative_rmse"].get<double>();
  };
  CHECK(error(moved) < 0.5);
  CHECK(nlohmann::json::parse(moved.head.parameters)["em_angles"] == true);
  CHECK_THROWS_WITH(fit_with({"em_angles=true", "modes=half-light-view"}),
                    Catch::Contains("em_angles = true") && Catch::Contains("half-light-view") &&
                        Catch::Contains("optimal"));
}
