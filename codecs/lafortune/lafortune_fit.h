// Levenberg-Marquardt for one texel's Lafortune model over all pairs of lights and views (paper 003
// compares with it; Lafortune et al., SIGGRAPH 1997), in doubles, eight pairs side by side.
//
// A lobe (C . m)^n, m = (lx vx, ly vy, lz vz), is held as D = C / max|C|, its peak P = max|C|^n and
// n, for the reasons of codecs/lobes/lobe_fit.h.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "codecs/levenberg_marquardt.h"

namespace weft::lafortune {

inline constexpr int most_lobes = 3;
inline constexpr double least_exponent = 1;
inline constexpr double largest_exponent = 512;
/// Times the largest B / cos(theta_light) of the texel.
inline constexpr double largest_peak = 1.2;

struct Lobe {
  std::array<double, 3> axis{-1, -1, 1};  ///< D; its largest |component| is 1
  double peak = 0;
  double exponent = 1;
};

/// What the fit moves of a lobe, in this order: its axis, whose length is the peak (a change of
/// 1 + s is one of (1 + s)^n); the logarithm of its exponent. The diffuse term comes last.
inline constexpr int parameters_a_lobe = 4;

/// value(l, v) = cos(theta_light) (diffuse + sum of peak max(axis . m, 0)^exponent).
struct Lafortune {
  int count = 1;
  double diffuse = 0;  ///< 0 to `largest_peak`
  std::array<Lobe, most_lobes> lobe{};
};

/// The pairs of lights and views above the horizon, contiguous; what is behind `size()` is zero.
class PairTable {
 public:
  static constexpr std::size_t lanes = 8;

  PairTable(const HemisphereSampling& views, const HemisphereSampling& lights);

  std::size_t size() const { return pair_.size(); }
  std::size_t padded() const { return cosine_.size(); }
  /// view * lights + light of pair i.
  std::size_t pair(std::size_t i) const { return pair_[i]; }

  const double* x() const { return m_[0].data(); }  ///< lx vx
  const double* y() const { return m_[1].data(); }
  const double* z() const { return m_[2].data(); }
  const double* cosine() const { return cosine_.data(); }  ///< of the light

 private:
  std::vector<std::size_t> pair_;
  std::array<std::vector<double>, 3> m_;
  std::vector<double> cosine_;
};

/// The model's value at each pair, `padded()` of them, 0 beyond `size()`.
void evaluate(const PairTable& pairs, const Lafortune& model, std::span<double> values);

/// Sum of squared differences.
double squared_error(const PairTable& pairs, std::span<const double> values,
                     const Lafortune& model);

/// J^T J, J^T r and |r|^2 of the K = `model.count` lobes' parameters and the diffuse term, J the
/// derivatives of the model's values. K is 1 to `most_lobes`.
/// @param values  `padded()` of them, 0 beyond `size()`.
template <int K>
NormalEquations<parameters_a_lobe * K + 1> normal_equations(const PairTable& pairs,
                                                            std::span<const double> values,
                                                            const Lafortune& model);

/// Where a step of the parameters leads: cut to what the derivatives tell something about, peaks,
/// exponents and the diffuse term held within their bounds.
template <int K>
Lafortune stepped(const Lafortune& model,
                  const std::array<double, parameters_a_lobe * K + 1>& step);

/// The diffuse term and peaks that fit best for the given axes and exponents, within their bounds;
/// 0 where values are not finite.
void fit_heights(const PairTable& pairs, std::span<const double> values, Lafortune& model);

/// Improves `model` until it gains no more. @return its squared error.
double improve(const PairTable& pairs, std::span<const double> values, const FitLimits& limits,
               Lafortune& model);

/// What one texel's fit came to.
struct TexelFit {
  Lafortune model;
  double error = 0;        ///< squared, of values whose largest B / cosine is 1
  bool fell_back = false;  ///< no start did better than a broad mirror lobe and a diffuse term
};

/// The best of several starts: mirror, retro-reflective and directional diffuse lobes.
/// @param values  `padded()` of them; the largest value / cosine is 1.
TexelFit fit_texel(const PairTable& pairs, std::span<const double> values, int count);

}  // namespace weft::lafortune
