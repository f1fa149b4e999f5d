// The exponentials and logarithms that are computed side by side are as near as their comments say.
#include "codecs/branchless_exp.h"

#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>

#include "codecs/branchless_double.h"
#include "codecs/wide_vector.h"

using namespace weft;

TEST_CASE("branchless_exp is within 3e-7 of itself over all that a float holds") {
  constexpr int count = 100000;
  double worst = 0;
  for (int i = 0; i <= count; ++i) {
    const float x = -87 + 175 * static_cast<float>(i) / count;
    worst = std::max(worst, std::abs(branchless_exp(x) / std::exp(static_cast<double>(x)) - 1));
  }
  CHECK(worst < 3e-7);
  CHECK(branchless_exp(0) == 1);
  CHECK(branchless_exp(-1000) == branchless_exp(-87));
  CHECK(branchless_exp(1000) == branchless_exp(88));
}

TEST_CASE("branchless_log is within 1.5e-7 of itself, or of 1") {
  double worst = 0;
  for (double exponent = -87; exponent < 88; exponent += 0.001) {
    const auto x = static_cast<float>(std::exp(exponent));
    const double expected = std::log(static_cast<double>(x));
    worst =
        std::max(worst, std::abs(branchless_log(x) - expected) / std::max(std::abs(expected), 1.0));
  }
  CHECK(worst < 1.5e-7);
  CHECK(branchless_log(1) == 0);
}

TEST_CASE("branchless_power is within 4e-7 (1 + its logarithm) of itself") {
  double worst = 0;
  for (const float n : {0.3F, 1.F, 30.F, 512.F}) {
    for (double log = -86; log <= 0; log += 0.003) {
      const auto x = static_cast<float>(std::exp(log / std::max(n, 1.F)));
      const double exact = n * std::log(static_cast<double>(x));
      worst = std::max(
          worst, std::abs(branchless_power(x, n) / std::exp(exact) - 1) / (1 + std::abs(exact)));
    }
  }
  CHECK(worst < 4e-7);
  CHECK(branchless_power(1, 512) == Approx(1).epsilon(4e-7));
  CHECK(branchless_power(0.3F, 0) == Approx(1).epsilon(4e-7));
  for (const float x : {0.F, 1e-40F, 0.5F}) CHECK(branchless_power(x, 512) < 1e-37F);
}

TEST_CASE("branchless_powers of vectors are those of floats, and wrap around where there is none") {
  std::array<Wide, 3> x{};
  std::array<Wide, 3> n{};
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < wide_lanes; ++i) {
      x[k][i] = std::exp(-static_cast<float>(3 * i + k));
      n[k][i] = k == 2 ? -150.0F : 0.4F + static_cast<float>(k);
    }
  }
  const std::array<Wide, 3> powers = branchless_powers<WideInt, WideUnsigned>(x, n);
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t i = 0; i < wide_lanes; ++i) {
      INFO(k << ", lane " << i);
      // Products and sums are fused here or there.
      const double log = n[k][i] * std::log(x[k][i]);
      CHECK(powers[k][i] == Approx(branchless_power(x[k][i], n[k][i])).epsilon(4e-7 * (1 - log)));
    }
  }
  // e^(150 (3 i + 2)) is no float: some number, and nothing that a sanitizer stops at.
  CHECK_NOTHROW(branchless_power(x[2][1], n[2][1]));
}

TEST_CASE("Eight exponentials and logarithms of doubles are within 1e-12") {
  double worst = 0;
  for (double x = -690; x < 690; x += 0.037) {
    const DoubleLanes lanes = exp_lanes(DoubleLanes{} + x);
    worst = std::max(worst, std::abs(lanes[3] / std::exp(x) - 1));
    const double back = log_lanes(lanes)[5];
    worst = std::max(worst, std::abs(back - std::log(lanes[5])) / std::max(std::abs(x), 1.0));
  }
  CHECK(worst < 1e-12);
}
