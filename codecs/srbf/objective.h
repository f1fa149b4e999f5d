// What a texel's kernels are fitted by: the error at its samples (paper 001, equation 3.8) and the
// pull of its parent and neighbours (3.13, 3.14), with its gradient.
//
// The colours F_j are linear in the error, so that they are solved for exactly wherever centres and
// angles are tried (variable projection): at that optimum the gradient with respect to the others
// is what it is with the colours held.
#pragma once

#include <span>
#include <vector>

#include "codecs/srbf/kernels.h"
#include "codecs/srbf/samples.h"

namespace weft::srbf {

/// Weights of squared differences: of centres p, angles and colours.
struct PullWeights {
  double centre = 0;
  double angle = 0;
  double colour = 0;
};

/// Adds the weighted squared distance to `target` (as Kernels::values), where a weight is not 0.
struct Pull {
  PullWeights weight;
  std::vector<double> target;
};

/// Keeps numbers bounded where the data do not: weights of |p|^2, |F|^2, and of each kernel's own
/// mean square over the samples, |F|^2 mean(G^2).
struct Ridge {
  double centre = 1e-10;
  double colour = 1e-9;
  double share = 2e-6;
};

class Objective {
 public:
  /// @param samples  outlives this.
  Objective(const Samples& samples, Shape shape, Ridge ridge);

  /// @param channels  as `channel_arrays`; outlives the calls below.
  void set_texel(std::span<const float> channels) { channels_ = channels; }
  void set_pull(Pull pull) { pull_ = std::move(pull); }

  struct Value {
    double total = 0;
    double data = 0;  ///< mean of squared errors of B, over all pairs and channels
  };
  /// Solves for the colours of `kernels`; where `gradient` is not empty, writes d total / d
  /// unknowns, 0 for the angles unless `free_angles`.
  Value operator()(Kernels& kernels, std::span<double> gradient, bool free_angles);

  /// Mean square of each kernel's Gaussian over the samples, as last evaluated.
  std::vector<double> gaussian_squares() const;

 private:
  template <std::size_t K>
  Value run(Kernels& kernels, std::span<double> gradient, bool free_angles);
  template <std::size_t K>
  void fill_gaussians(const Kernels& kernels, std::size_t block);
  void add_normal_equations(std::size_t block);
  void solve_colours(Kernels& kernels) const;
  template <std::size_t K>
  double add_errors(const Kernels& kernels, std::size_t block, bool with_gradient,
                    bool free_angles);
  template <std::size_t K>
  void write_gradient(const Kernels& kernels, std::span<double> gradient, bool free_angles) const;
  Value with_penalties(const Kernels& kernels, double squares, std::span<double> gradient,
                       bool free_angles) const;

  float* gaussians(std::size_t block) { return &gaussians_[block * padded_ * block_samples]; }

  const Samples& samples_;
  Shape shape_;
  Ridge ridge_;
  std::size_t padded_;  // kernels, a multiple of four
  double numbers_;      // that data are a mean of
  std::span<const float> channels_;
  Pull pull_;

  // Sums are kept lane by lane until the end.
  std::vector<float> gaussians_;   // [block][kernel][sample], times the gain
  std::vector<float> shares_;      // [kernel][sample] of a block: d error / d exponent
  std::vector<float> normal_;      // [tile row][tile column][4][4][lane]
  std::vector<float> right_;       // [kernel][rgb][lane]
  std::vector<float> centre_sum_;  // [kernel][3 K + 1][lane]: of shares times psi, of shares
  std::vector<float> angle_sum_;   // [mode][lane]
};

}  // namespace weft::srbf
