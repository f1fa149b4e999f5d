// Weighted least squares for the texels of one parabolic map from what its bilinear lookups are to
// return.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "codecs/factor_maps/parabolic_map.h"

namespace weft::factor_maps {

/// Minimises  sum over sites of weight (lookup(map) - wanted)^2 + mu * (what the change of the map
/// differs between neighbours)^2  over changes of a map. Where no site asks, or sites that weigh
/// little, the change is spread evenly from what is asked around.
class MapEquations {
 public:
  /// @param smoothness  mu, of the mean weight of a texel.
  MapEquations(int resolution, double smoothness);

  /// Adds a site.
  /// @param weight    >= 0.
  /// @param residual  weight * (wanted - what the map returns now).
  void add(const BilinearTaps& taps, double weight, double residual);

  /// `map` changed by conjugate gradients, kept >= 0: what would fall below is held at 0 while the
  /// others are solved again. Never worse than `map`, which is what the residuals were added for;
  /// the same where no site has a weight.
  std::vector<double> solved(const std::vector<double>& map) const;

 private:
  using Values = Eigen::ArrayXd;
  // The matrix's entries between a texel and itself, and the ones to the right, below left, below
  // and below right of it; it is symmetric. Texels lie in a border of zeros, so that whole arrays
  // are multiplied at once.
  struct Matrix {
    Values own, right, below_left, below, below_right;
  };

  Eigen::Index place(Eigen::Index texel) const;
  Values times(const Matrix& matrix, const Values& x) const;
  Matrix smoothed(double mu) const;
  Values change(const Matrix& matrix, const Values& start, const Values& free) const;

  Eigen::Index resolution_;
  Eigen::Index stride_;
  double smoothness_;
  Matrix matrix_;
  Values residual_;
};

}  // namespace weft::factor_maps
