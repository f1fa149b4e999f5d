// Fits kernels to every texel of every mip level, from the top down (paper 001, section 3.3).
#pragma once

#include <string>

#include "btf/btf.h"
#include "btf/progress.h"
#include "codecs/srbf/minimise.h"
#include "codecs/srbf/model.h"
#include "codecs/srbf/modes.h"
#include "settings/settings.h"

namespace weft::srbf {

struct FitOptions {
  std::size_t kernels = 20;
  Modes modes;
  Quantity quantity = Quantity::radiance;
  Storage storage = Storage::half;
  Filtering filtering = Filtering::values;
  /// Of L-BFGS, a descent; at the top four times as many.
  int iterations = DescentLimits{}.iterations;
  /// A descent ends where ten iterations lower what is minimised, pulls included, by less,
  /// relatively; at the top by less than a fifth of it.
  double decrease = DescentLimits{}.decrease;
  int starts = 4;            ///< descents at the top, each from another guess
  int sweeps = 1;            ///< over a level, after the one that starts from its parents
  double mip_weight = 0;     ///< c_mip of equation 3.13
  double smooth_weight = 0;  ///< c_smooth of equation 3.14
  bool robust = true;        ///< neighbours across an edge don't pull
  bool restarts = true;      ///< from neighbours' kernels, where those fit a texel better
};

/// What is not named has the defaults above, but for `Filtering::numbers`, which brings pulls.
/// @throws Error  for an unknown key, a value out of range, or pulls that could do nothing.
FitOptions fit_options(const Settings& parameters);
/// Lines "name = default   meaning".
std::string parameter_help();
/// Every parameter, as canonical JSON.
std::string to_json(const FitOptions& options);

/// @throws Error  naming view, light and texel of a value that is not finite and >= 0.
Model fit(const Btf& btf, const FitOptions& options, Progress& progress);

}  // namespace weft::srbf
