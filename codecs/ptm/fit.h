// Fits a polynomial texture map to each measured view: a biquadratic polynomial of the light a
// texel (Malzbender, Gelb and Wolters, SIGGRAPH 2001).
#pragma once

#include "btf/btf.h"
#include "btf/progress.h"
#include "codecs/reflectance_fields/model.h"
#include "settings/settings.h"

namespace weft::ptm {

struct FitOptions {
  bool per_channel = false;    ///< a polynomial for each of RGB, or luminance times a colour
  bool cosine_outside = true;  ///< times cos(theta_light), or the polynomial is the value itself
  Storage storage = Storage::half;
};

/// @throws Error  for an unknown key or a value out of range.
FitOptions fit_options(const Settings& parameters);
/// Lines "name = default   meaning".
std::string parameter_help();
/// Every parameter, as canonical JSON.
std::string to_json(const FitOptions& options);

/// Linear least squares of B, the cosine included, over the lights above the horizon; the shortest
/// coefficients where there are too few lights. One factorisation serves all views and texels.
/// @throws Error  naming view, light and texel of a value that is not finite and >= 0.
reflectance_fields::Model fit(const Btf& btf, const FitOptions& options, Progress& progress);

}  // namespace weft::ptm
