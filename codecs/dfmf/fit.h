// Fits a DFMF: three truncated singular value decompositions.
#pragma once

#include <string>

#include "btf/btf.h"
#include "btf/progress.h"
#include "codecs/dfmf/model.h"
#include "settings/settings.h"

namespace weft::dfmf {

struct FitOptions {
  std::array<std::size_t, 3> components{16, 8, 8};  ///< of log Y, U / Y, V / Y
  double epsilon = 0.01;                            ///< times the mean luminance of f
  Storage storage = Storage::half;
};

/// @throws Error  for an unknown key or a value out of range.
FitOptions fit_options(const Settings& parameters);
/// Lines "name = default   meaning".
std::string parameter_help();
/// Every parameter, as canonical JSON.
std::string to_json(const FitOptions& options);

/// @throws Error  naming view, light and texel of a value that is not finite and >= 0.
Model fit(const Btf& btf, const FitOptions& options, Progress& progress);

}  // namespace weft::dfmf
