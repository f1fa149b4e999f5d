// Fits a Lafortune model to each texel, its luminance over all lights and views.
#pragma once

#include "btf/btf.h"
#include "btf/progress.h"
#include "codecs/lafortune/model.h"
#include "settings/settings.h"

namespace weft::lafortune {

struct FitOptions {
  int lobes = 2;
  Storage storage = Storage::half;
};

/// @throws Error  for an unknown key or a value out of range.
FitOptions fit_options(const Settings& parameters);
/// Lines "name = default   meaning".
std::string parameter_help();
/// Every parameter, as canonical JSON.
std::string to_json(const FitOptions& options);

/// Row by row, its texels side by side; rows that are done are kept in `progress.kept_in()`, and
/// how many texels fell back is reported to `progress`.
/// @throws Error  naming view, light and texel of a value that is not finite and >= 0.
Model fit(const Btf& btf, const FitOptions& options, Progress& progress);

}  // namespace weft::lafortune
