// Fits a homomorphic factorisation to a BTF.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "btf/btf.h"
#include "btf/progress.h"
#include "codecs/factor_maps/model.h"
#include "codecs/factor_maps/storage.h"
#include "settings/settings.h"

namespace weft::hf {

struct FitOptions {
  factor_maps::StorageOptions storage;
  std::optional<double> lambda = 1;  ///< smoothing (see `log_system.h`); none: found by `auto`
  double floor = 0.1;                ///< least f in the logarithm, as a share of the ABRDF's mean
};

/// @throws Error  for an unknown key or a value out of range.
FitOptions fit_options(const Settings& parameters);

/// Lines "name = default   meaning".
std::string parameter_help();

/// @throws Error  naming view, light and texel of a value that is not finite and >= 0.
factor_maps::Model fit(const std::shared_ptr<const Btf>& btf, const FitOptions& options,
                       Progress& progress);

}  // namespace weft::hf
