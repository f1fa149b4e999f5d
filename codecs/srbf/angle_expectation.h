// What expectation and maximisation make of a mode's angle (paper 001, equation 3.11).
#pragma once

#include <vector>

#include "btf/direction.h"

namespace weft::srbf {

/// Q of equation 3.11 for one mode k, as a function of its angle: the sum over samples of
/// (sum over j of T P_jk lambda_jk xi_jk) . psi_k(angle), shares P and centres held.
class AngleExpectation {
 public:
  /// @param pull  of the sample: the bracket above.
  void add(const double (&pull)[3], const Direction& light, const Direction& view);  // NOLINT
  /// Q.
  double operator()(double angle) const;
  /// The angle of the largest Q found within 22.5 degrees of `angle`: Q is never less there.
  double best_near(double angle) const;

 private:
  // The pull's products with light and view, and the cosine between these.
  struct Sample {
    double light;
    double view;
    double cosine;
  };
  std::vector<Sample> samples_;
};

}  // namespace weft::srbf
