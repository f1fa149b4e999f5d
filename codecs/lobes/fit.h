// Fits the reflectance field of each measured view and texel (paper 003, section 4.2).
#pragma once

#include "btf/btf.h"
#include "btf/progress.h"
#include "codecs/lobes/lobe_fit.h"
#include "codecs/reflectance_fields/model.h"
#include "settings/settings.h"

namespace weft::lobes {

struct FitOptions {
  int lobes = 2;  ///< the paper's k
  Storage storage = Storage::half;
};

/// @throws Error  for an unknown key or a value out of range.
FitOptions fit_options(const Settings& parameters);
/// Lines "name = default   meaning".
std::string parameter_help();
/// Every parameter, as canonical JSON.
std::string to_json(const FitOptions& options);

/// What one field's fit came to.
struct FieldFit {
  LobeSum lobes;
  double error = 0;        ///< squared, of values whose largest is 1
  bool fell_back = false;  ///< no start did better than c cos(theta_light)
};

/// The best of several starts, and of `others`, each with `count` lobes or more.
/// @param values  `lights.padded()` of them, 0 beyond `lights.size()`; the largest is 1.
FieldFit fit_field(const LightTable& lights, std::span<const double> values, int count,
                   std::span<const LobeSum> others = {});

/// View by view, all texels side by side; what is done is kept in `progress.kept_in()`, and counts
/// of what fell back or stands at a bound are reported to `progress`.
/// @throws Error  naming view, light and texel of a value that is not finite and >= 0.
reflectance_fields::Model fit(const Btf& btf, const FitOptions& options, Progress& progress);

}  // namespace weft::lobes
