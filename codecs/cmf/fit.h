// Fits a CMF to a BTF: rotation, chain, and what `factor_maps::assemble` makes of the maps.
#pragma once

#include <memory>
#include <string>

#include "btf/btf.h"
#include "btf/progress.h"
#include "codecs/cmf/chain.h"
#include "codecs/factor_maps/model.h"
#include "codecs/factor_maps/storage.h"
#include "settings/settings.h"

namespace weft::cmf {

struct FitOptions {
  ChainOptions chain;
  factor_maps::StorageOptions storage;
  bool rotate = false;  ///< turn each ABRDF into its direction of greatest anisotropy first
};

/// @throws Error  for an unknown key or a value out of range.
FitOptions fit_options(const Settings& parameters);

/// Lines "name = default   meaning".
std::string parameter_help();

/// Every parameter, as canonical JSON.
std::string to_json(const FitOptions& options);

/// @throws Error  naming view, light and texel of a value that is not finite and >= 0.
factor_maps::Model fit(const std::shared_ptr<const Btf>& btf, const FitOptions& options,
                       Progress& progress);

}  // namespace weft::cmf
