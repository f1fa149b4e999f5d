// Levenberg and Marquardt's least squares for a few parameters, known when it is compiled: no
// allocation, so that many thousands of small fits are made side by side. The problem brings its
// normal equations, and how a point moves, which keeps it within bounds.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace weft {

/// J^T J (its lower triangle) and J^T r at a point, r = data - model, and |r|^2.
template <int N>
struct NormalEquations {
  std::array<std::array<double, N>, N> matrix;
  std::array<double, N> right;
  double error = 0;
};

struct FitLimits {
  int iterations = 40;
  double tolerance = 1e-5;  ///< of the error, relative, that a step must gain at least
};

/// Solves (J^T J + damping diag) step = J^T r by Cholesky; a parameter that is not free stays.
/// False where the matrix is not positive.
template <int N>
bool damped_step(const NormalEquations<N>& normal, const std::array<bool, N>& free, double damping,
                 std::array<double, N>& step) {
  double largest = 0;
  for (int a = 0; a < N; ++a) largest = std::max(largest, normal.matrix[a][a]);
  std::array<std::array<double, N>, N> l;
  for (int a = 0; a < N; ++a) {
    for (int b = 0; b <= a; ++b) {
      double sum = free[a] && free[b] ? normal.matrix[a][b] : 0;
      // A parameter that the data say nothing about is held too.
      if (a == b) sum = free[a] ? sum + damping * (sum + 1e-9 * largest) + 1e-300 : 1;
      for (int c = 0; c < b; ++c) sum -= l[a][c] * l[b][c];
      if (a != b) {
        l[a][b] = sum / l[b][b];
      } else {
        if (!(sum > 0)) return false;
        l[a][a] = std::sqrt(sum);
      }
    }
  }
  for (int a = 0; a < N; ++a) {
    double sum = free[a] ? normal.right[a] : 0;
    for (int c = 0; c < a; ++c) sum -= l[a][c] * step[c];
    step[a] = sum / l[a][a];
  }
  for (int a = N - 1; a >= 0; --a) {
    double sum = step[a];
    for (int c = a + 1; c < N; ++c) sum -= l[c][a] * step[c];
    step[a] = sum / l[a][a];
  }
  return true;
}

/// Improves `point` until a step gains too little.
/// @param equations  NormalEquations<N>(point).
/// @param free       std::array<bool, N>(equations, point): false for a parameter at a bound that
///                   the gradient pushes beyond.
/// @param moved      the point that a step leads to, within the bounds.
/// @return the squared error at the end, never more than at the start unless that is not finite.
template <int N, typename Point, typename Equations, typename Free, typename Moved>
double levenberg_marquardt(const FitLimits& limits, Point& point, const Equations& equations,
                           const Free& free, const Moved& moved) {
  constexpr double most_damping = 1e6;
  NormalEquations<N> here = equations(point);
  double damping = 1e-2;
  for (int i = 0; i < limits.iterations && damping < most_damping; ++i) {
    std::array<double, N> step;
    if (damped_step<N>(here, free(here, point), damping, step)) {
      const Point next = moved(point, step);
      const NormalEquations<N> there = equations(next);
      if (there.error < here.error) {
        const bool is_done = there.error > (1 - limits.tolerance) * here.error;
        point = next;
        here = there;
        damping = std::max(damping * 0.2, 1e-12);
        if (is_done) break;
        continue;
      }
    }
    damping = std::max(damping, 1e-6) * 6;
  }
  return here.error;
}

}  // namespace weft
