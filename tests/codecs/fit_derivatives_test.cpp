// The derivatives that Levenberg and Marquardt are told, of sums of lobes and of Lafortune models,
// are what differences of the models' values say: at random points, beside the edge where a scalar
// product passes zero, and at the bounds of exponents, peaks and the diffuse term.

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <vector>

#include "btf/random.h"
#include "codecs/lafortune/lafortune_fit.h"
#include "codecs/lobes/lobe_fit.h"

using namespace weft;

namespace {

double unit(std::uint64_t index, int dimension) {
  return unit_float(hash_coordinates(57, index, dimension));
}

const HemisphereSampling& sampling() {
  static const HemisphereSampling sampling(named_directions("regular:5x12"));
  return sampling;
}

std::vector<double> random_values(std::size_t count, std::size_t padded, std::uint64_t index) {
  std::vector<double> values(padded);
  for (std::size_t i = 0; i < count; ++i) values[i] = unit(index, static_cast<int>(1000 + i));
  return values;
}

/// Derivatives along each parameter, second order in the step. `side` of a parameter: 0 between its
/// bounds, 1 or -1 where steps may only lead up or down.
template <int N, typename Values, typename Side>
std::array<std::vector<double>, N> differences(const Values& values_at, const Side& side) {
  constexpr double h = 1e-6;
  std::array<std::vector<double>, N> columns;
  for (int a = 0; a < N; ++a) {
    const auto at = [&](double by) {
      std::array<double, N> step{};
      step[a] = by;
      return values_at(step);
    };
    const int s = side(a);
    const std::vector<double> here = at(0);
    const std::vector<double> one = at(s == 0 ? -h : s * h);
    const std::vector<double> two = at(s == 0 ? h : 2 * s * h);
    for (std::size_t i = 0; i < here.size(); ++i) {
      columns[a].push_back(s == 0 ? (two[i] - one[i]) / (2 * h)
                                  : s * (4 * one[i] - 3 * here[i] - two[i]) / (2 * h));
    }
  }
  return columns;
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

template <int N>
void expect_derivatives(const NormalEquations<N>& normal,
                        const std::array<std::vector<double>, N>& columns,
                        std::vector<double> residual, const std::vector<double>& model) {
  constexpr double tolerance = 1e-5;  // of the two vectors' lengths
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= model[i];
  CHECK(normal.error == Approx(product(residual, residual)));
  const double length = std::sqrt(normal.error);
  std::array<double, N> norm{};
  for (int a = 0; a < N; ++a) norm[a] = std::sqrt(product(columns[a], columns[a])) + 1e-4;
  for (int a = 0; a < N; ++a) {
    INFO("parameter " << a);
    CHECK(std::abs(normal.right[a] - product(columns[a], residual)) < tolerance * norm[a] * length);
    for (int b = 0; b <= a; ++b) {
      INFO("and " << b);
      CHECK(std::abs(normal.matrix[a][b] - product(columns[a], columns[b])) <
            tolerance * norm[a] * norm[b]);
    }
  }
}

/// 1 at the lower bound, -1 at the upper one, else 0.
int inwards(double value, double least, double largest) {
  return value <= least ? 1 : value >= largest ? -1 : 0;
}

/// Its bounds and what lies between them, in turn.
double at_bound_or(std::uint64_t turn, double least, double largest, double between) {
  return turn % 3 == 0 ? least : turn % 3 == 1 ? largest : between;
}

/// A unit vector in doubles: exponents raise what rounding leaves.
std::array<double, 3> normalised(std::array<double, 3> v) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (double& a : v) a /= length;
  return v;
}

std::array<double, 3> direction(std::uint64_t index, int first) {
  const Direction d =
      from_spherical(std::acos(2 * unit(index, first) - 1), radians(360 * unit(index, first + 1)));
  return normalised({d.x, d.y, d.z});
}

}  // namespace

namespace {

using lobes::Lobe;
using lobes::LobeSum;

template <int K>
void expect_lobe_derivatives(const lobes::LightTable& lights, const LobeSum& at,
                             std::uint64_t index) {
  constexpr int n = lobes::parameters_a_lobe * K;
  const auto values_at = [&](const std::array<double, n>& step) {
    std::vector<double> values(lights.padded());
    lobes::evaluate(lights, lobes::stepped<K>(at, step), values);
    return values;
  };
  const auto side = [&](int a) {
    const Lobe& lobe = at.lobe[a / 4];
    if (a % 4 == 2) return inwards(lobe.peak, 0, lobes::largest_peak);
    if (a % 4 == 3) return inwards(lobe.exponent, lobes::least_exponent, lobes::largest_exponent);
    return 0;
  };
  const std::vector<double> data = random_values(lights.size(), lights.padded(), index);
  expect_derivatives<n>(lobes::normal_equations<K>(lights, data, at),
                        differences<n>(values_at, side), data, values_at({}));
}

LobeSum random_lobes(std::uint64_t index, int count) {
  LobeSum sum;
  sum.count = count;
  for (int k = 0; k < count; ++k) {
    sum.lobe[k] = {direction(index, 8 * k), lobes::largest_peak * unit(index, 8 * k + 2),
                   std::pow(lobes::largest_exponent, unit(index, 8 * k + 3))};
  }
  return sum;
}

void expect_lobe_derivatives(const lobes::LightTable& lights, const LobeSum& at,
                             std::uint64_t index) {
  if (at.count == 1) return expect_lobe_derivatives<1>(lights, at, index);
  if (at.count == 2) return expect_lobe_derivatives<2>(lights, at, index);
  if (at.count == 3) return expect_lobe_derivatives<3>(lights, at, index);
  expect_lobe_derivatives<4>(lights, at, index);
}

}  // namespace

TEST_CASE("Derivatives of sums of lobes are what differences say, from any direction") {
  // Axes below the horizon too, so that most lights are behind some lobe.
  const lobes::LightTable lights(sampling());
  for (std::uint64_t i = 0; i < 80; ++i)
    expect_lobe_derivatives(lights, random_lobes(i, 1 + static_cast<int>(i % 4)), i);
}

TEST_CASE("Derivatives of lobes are what differences say at the bounds of peak and exponent") {
  const lobes::LightTable lights(sampling());
  for (std::uint64_t i = 0; i < 36; ++i) {
    LobeSum at = random_lobes(100 + i, 2);
    for (Lobe& lobe : at.lobe) {
      lobe.peak = at_bound_or(i, 0, lobes::largest_peak, lobe.peak);
      lobe.exponent =
          at_bound_or(i / 3, lobes::least_exponent, lobes::largest_exponent, lobe.exponent);
    }
    expect_lobe_derivatives(lights, at, i);
  }
}

TEST_CASE("Derivatives of lobes are what differences say beside a lobe's edge") {
  const lobes::LightTable lights(sampling());
  for (std::uint64_t i = 0; i < 60; ++i) {
    // A light whose scalar product is just above zero, or just below, where there is nothing.
    const double cosine = (i % 2 == 0 ? 1 : -1) * std::pow(10.0, -1 - 2.0 * unit(i, 50));
    const auto light = lights.direction(i % lights.size());
    const Direction l(static_cast<float>(light[0]), static_cast<float>(light[1]),
                      static_cast<float>(light[2]));
    const Direction across = (l % Direction(0.3F, -0.5F, 0.8F)).normalized();
    LobeSum at = random_lobes(200 + i, 1);
    const double sine = std::sqrt(1 - cosine * cosine);
    for (int c = 0; c < 3; ++c) at.lobe[0].axis[c] = cosine * light[c] + sine * across[c];
    at.lobe[0].axis = normalised(at.lobe[0].axis);
    at.lobe[0].exponent = 1 + 3 * unit(i, 51);
    expect_lobe_derivatives(lights, at, i);
  }
}

namespace {

using lafortune::Lafortune;

template <int K>
void expect_lafortune_derivatives(const lafortune::PairTable& pairs, const Lafortune& at,
                                  std::uint64_t index) {
  constexpr int n = lafortune::parameters_a_lobe * K + 1;
  const auto values_at = [&](const std::array<double, n>& step) {
    std::vector<double> values(pairs.padded());
    lafortune::evaluate(pairs, lafortune::stepped<K>(at, step), values);
    return values;
  };
  const auto side = [&](int a) {
    if (a == n - 1) return inwards(at.diffuse, 0, lafortune::largest_peak);
    const lafortune::Lobe& lobe = at.lobe[a / 4];
    if (a % 4 == 3)
      return inwards(lobe.exponent, lafortune::least_exponent, lafortune::largest_exponent);
    // The longest component carries the peak: outwards is higher.
    const double component = lobe.axis[a % 4];
    if (std::abs(component) < 1 || lobe.peak < lafortune::largest_peak) return 0;
    return component > 0 ? -1 : 1;
  };
  const std::vector<double> data = random_values(pairs.size(), pairs.padded(), index);
  expect_derivatives<n>(lafortune::normal_equations<K>(pairs, data, at),
                        differences<n>(values_at, side), data, values_at({}));
}

Lafortune random_model(std::uint64_t index, int count) {
  Lafortune model{.count = count, .diffuse = unit(index, 70)};
  for (int k = 0; k < count; ++k) {
    lafortune::Lobe& lobe = model.lobe[k];
    lobe.axis = direction(index, 8 * k);
    if (k == 0) lobe.axis[2] = std::abs(lobe.axis[2]);
    double largest = 0;
    for (const double a : lobe.axis) largest = std::max(largest, std::abs(a));
    for (double& a : lobe.axis) a /= largest;
    lobe.peak = 0.01 + unit(index, 8 * k + 2);
    lobe.exponent = std::pow(lafortune::largest_exponent, unit(index, 8 * k + 3));
  }
  return model;
}

void expect_lafortune_derivatives(const lafortune::PairTable& pairs, const Lafortune& at,
                                  std::uint64_t index) {
  if (at.count == 1) return expect_lafortune_derivatives<1>(pairs, at, index);
  if (at.count == 2) return expect_lafortune_derivatives<2>(pairs, at, index);
  expect_lafortune_derivatives<3>(pairs, at, index);
}

const lafortune::PairTable& some_pairs() {
  static const HemisphereSampling views(named_directions("regular:3x5"));
  static const lafortune::PairTable pairs(views, sampling());
  return pairs;
}

}  // namespace

TEST_CASE("Derivatives of Lafortune's model are what differences say, whatever the axes") {
  for (std::uint64_t i = 0; i < 45; ++i)
    expect_lafortune_derivatives(some_pairs(), random_model(i, 1 + static_cast<int>(i % 3)), i);
}

TEST_CASE("Derivatives of Lafortune's model are what differences say at its bounds") {
  for (std::uint64_t i = 0; i < 27; ++i) {
    Lafortune at = random_model(300 + i, 2);
    at.diffuse = at_bound_or(i, 0, lafortune::largest_peak, at.diffuse);
    for (lafortune::Lobe& lobe : at.lobe) {
      lobe.exponent =
          at_bound_or(i / 3, lafortune::least_exponent, lafortune::largest_exponent, lobe.exponent);
      if (i / 9 == 1) lobe.peak = lafortune::largest_peak;
    }
    expect_lafortune_derivatives(some_pairs(), at, i);
  }
}

TEST_CASE("Derivatives of Lafortune's model are what differences say beside a lobe's edge") {
  const lafortune::PairTable& pairs = some_pairs();
  for (std::uint64_t i = 0; i < 30; ++i) {
    // The third component is such that one pair's product is just above zero, or just below.
    Lafortune at = random_model(400 + i, 1);
    std::size_t pair = i * 29 % pairs.size();
    while (pairs.z()[pair] < 0.3) pair = (pair + 1) % pairs.size();
    const double near = (i % 2 == 0 ? 1 : -1) * std::pow(10.0, -2 - unit(i, 60));
    auto& axis = at.lobe[0].axis;
    axis[2] = (near - axis[0] * pairs.x()[pair] - axis[1] * pairs.y()[pair]) / pairs.z()[pair];
    double largest = 0;
    for (const double a : axis) largest = std::max(largest, std::abs(a));
    for (double& a : axis) a /= largest;
    at.lobe[0].exponent = 1 + 3 * unit(i, 61);
    expect_lafortune_derivatives(pairs, at, i);
  }
}
