// Fits one texel from a given start, and finds a start where there is none.
#pragma once

#include <span>
#include <vector>

#include "codecs/srbf/minimise.h"
#include "codecs/srbf/objective.h"

namespace weft::srbf {

struct TexelFit {
  Kernels kernels;
  Objective::Value value;
  bool fell_back = false;  ///< a descent ended in nothing finite
};

class TexelFitter {
 public:
  /// @param samples  outlives this.
  TexelFitter(const Samples& samples, const Modes& modes, std::size_t kernels);

  /// @param channels  as `channel_arrays`; outlives the calls below.
  void set_texel(std::span<const float> channels);
  void set_pull(Pull pull) { objective_.set_pull(std::move(pull)); }

  /// What kernels are worth here, with the colours that suit this texel.
  TexelFit as_it_is(Kernels kernels);
  /// L-BFGS from `start`. A descent that diverges leaves the start, with its colours, or black
  /// where they are no numbers.
  TexelFit descend(const TexelFit& start, const DescentLimits& limits);
  /// The best of `starts` guesses, each fitted with its angles fixed, then (where they are) free:
  /// by expectation and maximisation from different samples, and one by narrow kernels at the
  /// largest errors, for data that are a few peaks.
  TexelFit from_scratch(int starts, const DescentLimits& limits);

 private:
  TexelFit descend(const TexelFit& start, const DescentLimits& limits, bool free_angles);
  TexelFit safe(TexelFit fit) const;
  std::vector<double> units(const Kernels& kernels) const;
  Kernels guess_of_peaks();
  std::size_t largest_error(const Kernels& kernels) const;

  const Samples& samples_;
  const Modes& modes_;
  Shape shape_;
  Objective objective_;
  std::span<const float> channels_;
};

}  // namespace weft::srbf
