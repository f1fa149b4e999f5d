// Fits a CMF to a BTF: chain, normalisation, clustering, quantisation (paper 004, sections 4 and
// 5).
#pragma once

#include <cstdint>
#include <string>

#include "btf/btf.h"
#include "btf/progress.h"
#include "codecs/cmf/chain.h"
#include "codecs/cmf/model.h"
#include "settings/settings.h"

namespace weft::cmf {

struct FitOptions {
  ChainOptions chain;
  bool eight_bit = true;    ///< textures of 8 bits, otherwise float
  bool clustered = true;    ///< codebooks and index maps, otherwise every texel's own maps
  int clusters = 256;       ///< codebook size a factor
  bool refit_scale = true;  ///< solve the scale map again once the maps are what the GPU gets
  std::uint64_t seed = 0;   ///< of k-means++
};

/// @throws Error  for an unknown key or a value out of range.
FitOptions fit_options(const Settings& parameters);

/// Lines "name = default   meaning".
std::string parameter_help();

/// Every parameter, as canonical JSON.
std::string to_json(const FitOptions& options);

/// @throws Error  naming view, light and texel of a value that is not finite and >= 0.
Model fit(const Btf& btf, const FitOptions& options, Progress& progress);

}  // namespace weft::cmf
