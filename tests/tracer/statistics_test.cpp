// The statistical tests against tables, and against what they must notice.

#include "tests/statistics.h"

#include <random>

namespace {

using namespace weft::statistics;

TEST_CASE("p-values agree with the printed tables", "[statistics]") {
  CHECK(z_p_value(1.959963985) == Approx(0.05).epsilon(1e-8));
  CHECK(chi2_p_value(3.841458821, 1) == Approx(0.05).epsilon(1e-8));
  CHECK(chi2_p_value(18.30703805, 10) == Approx(0.05).epsilon(1e-8));
  CHECK(chi2_p_value(2.0, 100) == Approx(1.0));
  CHECK(t_p_value(2.228138852, 10) == Approx(0.05).epsilon(1e-8));
  CHECK(t_p_value(12.70620474, 1) == Approx(0.05).epsilon(1e-8));
  CHECK(sidak(0.05, 1) == Approx(0.05));
  CHECK(1 - std::pow(1 - sidak(0.05, 1000), 1000) == Approx(0.05));
}

TEST_CASE("Tests raise false alarms at their rate and notice what is wrong", "[statistics]") {
  std::mt19937 generator(1);
  std::normal_distribution<double> normal(3, 2);
  int alarms = 0;
  for (int i = 0; i < 2000; ++i) {
    std::vector<double> samples(8);
    for (double& s : samples) s = normal(generator);
    alarms += t_test(samples, 3) < 0.1 ? 1 : 0;
  }
  CHECK(alarms == Approx(200).margin(4 * std::sqrt(180.0)));

  std::vector<double> even(16, 100), skewed(16, 100), counts(16, 0);
  std::uniform_int_distribution<int> cell(0, 15);
  for (int i = 0; i < 1600; ++i) ++counts[cell(generator)];
  skewed[0] = 160;
  skewed[1] = 40;
  CHECK(chi2_test(counts, even) > 1e-3);
  CHECK(chi2_test(skewed, even) < 1e-6);
  const std::vector<double> nowhere{10, 10, 1}, expected{10, 11, 0};
  CHECK(chi2_test(nowhere, expected) == 0);
}

TEST_CASE("A slope is found with its error", "[statistics]") {
  const std::vector<double> x{0, 1, 2, 3}, line{1, -1, -3, -5}, bent{0, 1, 2, 2};
  CHECK(slope(x, line).slope == Approx(-2));
  CHECK(slope(x, line).error == Approx(0).margin(1e-12));
  CHECK(slope(x, bent).slope == Approx(0.7));
  CHECK(slope(x, bent).error == Approx(std::sqrt(0.3 / 2 / 5)));
}

}  // namespace
