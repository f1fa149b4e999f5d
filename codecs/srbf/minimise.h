// Limited-memory BFGS, by libLBFGS.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace weft::srbf {

struct DescentLimits {
  int iterations = 100;
  int memory = 20;         ///< pairs of steps and gradients that are kept
  double decrease = 1e-3;  ///< ends where ten iterations lower the value by less, relatively
  double enough = 1e-8;    ///< ends at this value: of data of mean square 1, what halfs can show
};

/// Lowers `value`, which answers f(x) and writes its gradient, from `x` on, which it replaces by
/// the best point found: never a worse one than at the start.
/// @return whether the end and its value are finite. A search that finds nothing lower than its
///         start has not failed: the start may be a minimum.
/// @throws std::bad_alloc
bool minimise(std::span<double> x,
              const std::function<double(std::span<const double>, std::span<double>)>& value,
              const DescentLimits& limits);

}  // namespace weft::srbf
