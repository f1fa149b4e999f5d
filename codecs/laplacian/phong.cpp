#include "codecs/laplacian/phong.h"

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <unsupported/Eigen/NonLinearOptimization>

namespace weft::laplacian {

namespace {

using Eigen::Index;

constexpr double largest_alpha = 1e4;
// How much higher than at the samples the lobe may be where there are none.
constexpr double largest_rise = 2;

struct Sample {
  double light_cosine;
  double log_half_cosine;  // of N.H
  double value;            // over the largest
};

// The squares of four parameters are ka, kd, ks and alpha, so that none is negative.
struct Residuals {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  static constexpr int InputsAtCompileTime = Eigen::Dynamic;
  static constexpr int ValuesAtCompileTime = Eigen::Dynamic;

  const std::vector<Sample>& samples;
  double alpha_bound;

  int inputs() const { return 4; }
  int values() const { return std::max(4, static_cast<int>(samples.size())); }

  double alpha(const InputType& p) const { return std::min(p[3] * p[3], alpha_bound); }

  double lobe(const Sample& s, const InputType& p) const {
    return std::exp(alpha(p) * s.log_half_cosine);
  }

  int operator()(const InputType& p, ValueType& residuals) const {
    residuals.setZero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Sample& s = samples[i];
      residuals[static_cast<Index>(i)] =
          p[0] * p[0] + p[1] * p[1] * s.light_cosine + p[2] * p[2] * lobe(s, p) - s.value;
    }
    return 0;
  }

  int df(const InputType& p, JacobianType& jacobian) const {
    jacobian.setZero();
    const double alpha_slope = p[3] * p[3] < alpha_bound ? 2 * p[3] : 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Sample& s = samples[i];
      const double l = lobe(s, p);
      jacobian.row(static_cast<Index>(i)) << 2 * p[0], 2 * p[1] * s.light_cosine, 2 * p[2] * l,
          alpha_slope * p[2] * p[2] * l * s.log_half_cosine;
    }
    return 0;
  }
};

std::vector<Sample> samples_of(const HemisphereSampling& views, const HemisphereSampling& lights,
                               const std::vector<double>& values, double largest) {
  std::vector<Sample> samples;
  std::size_t i = 0;
  for (const Direction& view : views.directions()) {
    for (const Direction& light : lights.directions()) {
      const double value = values[i++];
      if (!(light.z > 0) || !(view.z > 0)) continue;
      const Direction half = (light + view).normalized();
      samples.push_back(
          {light.z, std::log(std::min(1.0, static_cast<double>(half.z))), value / largest});
    }
  }
  return samples;
}

// A lobe that is sharper than the samples can tell has any height at N.H = 1 for nothing: where no
// sample comes near the mirror direction, alpha is bounded so that (N.H)^alpha rises little beyond.
double alpha_bound(const std::vector<Sample>& samples) {
  double nearest = -std::numeric_limits<double>::infinity();
  for (const Sample& s : samples) nearest = std::max(nearest, s.log_half_cosine);
  const double bound = largest_alpha;
  return -nearest * bound > std::log(largest_rise) ? std::log(largest_rise) / -nearest : bound;
}

}  // namespace

Phong fit_phong(const HemisphereSampling& views, const HemisphereSampling& lights,
                const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  if (!(largest > 0)) return {};
  const std::vector<Sample> samples = samples_of(views, lights, values, largest);
  const Residuals residuals{samples, alpha_bound(samples)};
  double least = std::numeric_limits<double>::infinity();
  Phong best;
  // A broad, a middling and a sharp lobe: the error has a valley for each.
  for (const double alpha : {2.0, 16.0, 128.0}) {
    Eigen::VectorXd p(4);
    p << 0.3, 0.5, 0.5, std::sqrt(std::min(alpha, residuals.alpha_bound / 2));
    Eigen::LevenbergMarquardt<const Residuals> solver(residuals);
    solver.parameters.maxfev = 200;
    solver.minimize(p);
    Eigen::VectorXd left(residuals.values());
    residuals(p, left);
    const double error = left.squaredNorm();
    if (!p.allFinite() || !(error < least)) continue;
    least = error;
    best = {static_cast<float>(p[0] * p[0] * largest), static_cast<float>(p[1] * p[1] * largest),
            static_cast<float>(p[2] * p[2] * largest), static_cast<float>(residuals.alpha(p))};
  }
  return best;
}

}  // namespace weft::laplacian
