// Statistical tests for what is only known up to noise: z, Student's t, chi-square, and the slope
// of a line.
//
// Each answers a p-value: how often chance alone gives a statistic at least as far out. A test that
// fails when p < alpha raises a false alarm at the rate alpha. Random numbers are fixed by a seed
// here, so a test that passed keeps passing until something changes; alpha = 1e-3 says how lucky
// that seed had to be. Where n results are held against one alpha, use `sidak(alpha, n)` for each,
// so that the family as a whole keeps the rate.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace weft::statistics {

/// Rate for each of `count` independent tests that gives the family the false-alarm rate `alpha`.
inline double sidak(double alpha, std::size_t count) {
  return -std::expm1(std::log1p(-alpha) / static_cast<double>(count));
}

/// Two-sided p-value of a normal variate.
inline double z_p_value(double z) {
  return std::erfc(std::abs(z) / std::sqrt(2.0));
}

/// Of an estimate whose own variance is known. Without variance: 1 where it is exact, else 0.
inline double z_test(double estimate, double expected, double variance) {
  if (variance == 0) return estimate == expected ? 1 : 0;
  return z_p_value((estimate - expected) / std::sqrt(variance));
}

/// Upper regularised incomplete gamma function Q(a, x): the series below a + 1, a continued
/// fraction above (Abramowitz and Stegun 6.5.29 and 6.5.31).
inline double upper_gamma(double a, double x) {
  if (x <= 0) return 1;
  const double scale = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (double n = a + 1; term > sum * 1e-16; ++n) {
      term *= x / n;
      sum += term;
    }
    return 1 - sum * scale;
  }
  double b = x + 1 - a, c = 1e300, d = 1 / b, fraction = d;
  for (int i = 1; i < 10000; ++i) {
    const double an = -i * (i - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    fraction *= d * c;
    if (std::abs(d * c - 1) < 1e-15) break;
  }
  return fraction * scale;
}

inline double chi2_p_value(double chi2, double degrees_of_freedom) {
  return upper_gamma(degrees_of_freedom / 2, chi2 / 2);
}

/// Pearson's test of counts against expected counts (which sum to the same up to rounding). Cells
/// that expect less than five are pooled, as the chi-square distribution asks for; so a cell that
/// expects nothing counts too.
inline double chi2_test(std::span<const double> observed, std::span<const double> expected) {
  double chi2 = 0, pooled_observed = 0, pooled_expected = 0;
  int cells = 0;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] < 5) {
      pooled_observed += observed[i];
      pooled_expected += expected[i];
      continue;
    }
    chi2 += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
    ++cells;
  }
  if (pooled_expected > 0) {
    chi2 +=
        (pooled_observed - pooled_expected) * (pooled_observed - pooled_expected) / pooled_expected;
    ++cells;
  } else if (pooled_observed > 0) {
    return 0;
  }
  return chi2_p_value(chi2, std::max(1, cells - 1));
}

/// Regularised incomplete beta function I_x(a, b) by its continued fraction (Abramowitz and
/// Stegun 26.5.8).
inline double incomplete_beta(double a, double b, double x) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  if (x > (a + 1) / (a + b + 2)) return 1 - incomplete_beta(b, a, 1 - x);
  const double scale = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                a * std::log(x) + b * std::log1p(-x)) /
                       a;
  double c = 1, d = 1 / (1 - (a + b) * x / (a + 1)), fraction = d;
  for (int m = 1; m < 10000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / (1 + even * d);
    c = 1 + even / c;
    fraction *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / (1 + odd * d);
    c = 1 + odd / c;
    fraction *= d * c;
    if (std::abs(d * c - 1) < 1e-15) break;
  }
  return fraction * scale;
}

/// Two-sided p-value of Student's t.
inline double t_p_value(double t, double degrees_of_freedom) {
  return incomplete_beta(degrees_of_freedom / 2, 0.5,
                         degrees_of_freedom / (degrees_of_freedom + t * t));
}

/// Of the mean of samples (at least two) against a known value.
inline double t_test(std::span<const double> samples, double expected) {
  const auto n = static_cast<double>(samples.size());
  double sum = 0, squares = 0;
  for (const double s : samples) sum += s;
  for (const double s : samples) squares += (s - sum / n) * (s - sum / n);
  if (squares == 0) return sum / n == expected ? 1 : 0;
  return t_p_value((sum / n - expected) / std::sqrt(squares / (n - 1) / n), n - 1);
}

/// Least-squares slope of y over x and its standard error (three points or more); e.g. of log error
/// over log samples, which is -1/2 for an unbiased estimate.
struct Slope {
  double slope = 0;
  double error = 0;
};
inline Slope slope(std::span<const double> x, std::span<const double> y) {
  const auto n = static_cast<double>(x.size());
  double mx = 0, my = 0, xx = 0, xy = 0, residual = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mx += x[i] / n;
    my += y[i] / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mx) * (x[i] - mx);
    xy += (x[i] - mx) * (y[i] - my);
  }
  for (std::size_t i = 0; i < x.size(); ++i)
    residual += std::pow(y[i] - my - xy / xx * (x[i] - mx), 2);
  return {xy / xx, std::sqrt(residual / (n - 2) / xx)};
}

}  // namespace weft::statistics
