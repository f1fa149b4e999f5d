#include "codecs/srbf/minimise.h"

#include <lbfgs.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>

namespace weft::srbf {

namespace {

using Value = std::function<double(std::span<const double>, std::span<double>)>;

// libLBFGS's vectors are aligned and a multiple of sixteen long.
struct Search {
  const Value& value;
  std::size_t count;
  double enough;
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();

  double operator()(const double* x, double* gradient, int padded) {
    const std::span<const double> at(x, count);
    const double found = value(at, {gradient, count});
    std::fill(gradient + count, gradient + padded, 0.0);
    if (found < least) {
      least = found;
      best.assign(at.begin(), at.end());
    }
    return found;
  }
};

double ask(void* search, const double* x, double* gradient, int n, double /*step*/) {
  return (*static_cast<Search*>(search))(x, gradient, n);
}

// Anything but 0 ends the search.
int is_enough(void* search, const double*, const double*, double value, double, double, double,
              int /*n*/, int /*iteration*/, int /*evaluations*/) {
  return value <= static_cast<Search*>(search)->enough ? 1 : 0;
}

}  // namespace

bool minimise(std::span<double> x, const Value& value, const DescentLimits& limits) {
  const auto padded = static_cast<int>((x.size() + 15) / 16 * 16);
  const std::unique_ptr<double, void (*)(double*)> vector(lbfgs_malloc(padded), lbfgs_free);
  if (!vector) throw std::bad_alloc();
  std::copy(x.begin(), x.end(), vector.get());
  std::fill(vector.get() + x.size(), vector.get() + padded, 0.0);
  Search search{
      .value = value, .count = x.size(), .enough = limits.enough, .best = {x.begin(), x.end()}};
  lbfgs_parameter_t parameters;
  lbfgs_parameter_init(&parameters);
  parameters.m = limits.memory;
  parameters.max_iterations = limits.iterations;
  parameters.past = 10;
  parameters.delta = limits.decrease;
  parameters.epsilon = 1e-9;
  double end = 0;
  // Most codes below 0 are no failure: iterations used up, or a line search that finds nothing
  // lower within rounding, which at a start that is a minimum already is at once.
  const int code = lbfgs(padded, vector.get(), &end, ask, is_enough, &search, &parameters);
  if (code == LBFGSERR_OUTOFMEMORY) throw std::bad_alloc();
  std::ranges::copy(search.best, x.begin());
  return std::isfinite(search.least) &&
         std::ranges::all_of(search.best, [](double v) { return std::isfinite(v); });
}

}  // namespace weft::srbf
