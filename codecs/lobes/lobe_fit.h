// Levenberg-Marquardt for a sum of K lobes over the lights of one reflectance field (paper 003,
// equation 1), in doubles, eight lights side by side.
//
// A lobe <(a, b, c), l>^n is held as its unit axis d, its peak P = |(a, b, c)|^n and n, so that
// (a, b, c) = P^(1/n) d: the same lobes, but P is linear, and bounding it is one comparison. In
// (a, b, c) the length and n undo each other; in (d, P, log n) the system is well conditioned.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "codecs/levenberg_marquardt.h"

namespace weft::lobes {

inline constexpr int most_lobes = 4;
/// Where a lobe's exponent is held. Below the least its edge is a step; beyond the largest it is
/// narrower than any sampling tells.
inline constexpr double least_exponent = 1;
inline constexpr double largest_exponent = 512;
/// A lobe's peak is at most this many times the largest sample, else a narrow lobe between samples
/// has any height.
inline constexpr double largest_peak = 1.2;

/// value(l) = peak max(<axis, l>, 0)^exponent.
struct Lobe {
  std::array<double, 3> axis{0, 0, 1};
  double peak = 0;
  double exponent = 1;

  bool operator==(const Lobe&) const = default;
};

/// What the fit moves of a lobe, in this order: two turns of its axis in radians, about two
/// tangents; its peak; the logarithm of its exponent.
inline constexpr int parameters_a_lobe = 4;

/// The first `count` are used.
struct LobeSum {
  int count = 1;
  std::array<Lobe, most_lobes> lobe{};
};

/// The lights above the horizon, as the fit reads them, and their neighbours.
class LightTable {
 public:
  static constexpr std::size_t lanes = 8;

  explicit LightTable(const HemisphereSampling& lights);

  /// Lights above the horizon.
  std::size_t size() const { return index_.size(); }
  /// A multiple of `lanes`; what is behind `size()` are zero vectors.
  std::size_t padded() const { return x_.size(); }
  /// Number of light i in the sampling.
  std::size_t index(std::size_t i) const { return index_[i]; }
  std::array<double, 3> direction(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }
  /// Those that share a triangle with light i.
  std::span<const std::size_t> neighbours(std::size_t i) const { return neighbours_[i]; }

  const double* x() const { return x_.data(); }
  const double* y() const { return y_.data(); }
  const double* z() const { return z_.data(); }

 private:
  std::vector<std::size_t> index_;
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> z_;
  std::vector<std::vector<std::size_t>> neighbours_;
};

/// The sum's value at each light, `padded()` of them, 0 beyond `size()`.
void evaluate(const LightTable& lights, const LobeSum& lobes, std::span<double> values);

/// Sum of squared differences.
double squared_error(const LightTable& lights, std::span<const double> values,
                     const LobeSum& lobes);

/// J^T J, J^T r and |r|^2 of the K = `lobes.count` lobes' parameters, J the derivatives of the
/// sum's values. K is 1 to `most_lobes`.
/// @param values  `padded()` of them, 0 beyond `size()`.
template <int K>
NormalEquations<parameters_a_lobe * K> normal_equations(const LightTable& lights,
                                                        std::span<const double> values,
                                                        const LobeSum& lobes);

/// Where a step of the parameters leads: turns and the change of an exponent cut to what the
/// derivatives tell something about, peak and exponent held within their bounds.
template <int K>
LobeSum stepped(const LobeSum& lobes, const std::array<double, parameters_a_lobe * K>& step);

/// Improves `lobes` until it gains no more; each step keeps peak and exponent within their bounds.
/// @param values  `padded()` of them, 0 beyond `size()`; the largest is 1.
/// @return its squared error, never more than the start's.
double improve(const LightTable& lights, std::span<const double> values, const FitLimits& limits,
               LobeSum& lobes);

/// The peaks that fit best for the given axes and exponents, each within its bounds; 0 where values
/// are not finite.
void fit_peaks(const LightTable& lights, std::span<const double> values, LobeSum& lobes);

}  // namespace weft::lobes
