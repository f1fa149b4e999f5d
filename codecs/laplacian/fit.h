// Fits a Laplacian BTF (paper 000, sections 3.1 and 3.2).
#pragma once

#include <string>

#include "btf/btf.h"
#include "btf/progress.h"
#include "codecs/laplacian/model.h"
#include "settings/settings.h"

namespace weft::laplacian {

/// Around what the top level's components are taken. `mean`: its true mean, which the model then
/// stands for (the paper). `model`: the model of the mean, whose error they mend at no cost.
enum class TopAround { mean, model };

struct FitOptions {
  std::array<std::size_t, 3> components{8, 2, 2};
  Filters filters = Filters::box3;
  int top = -1;  ///< lambda_max; -1: `usual_top`
  TopAround around = TopAround::model;
  ChromaMean chroma = ChromaMean::constant;
  bool closed_loop = true;  ///< each level predicted from what the coarser ones decode to
  bool interpolated = false;
  Storage storage = Storage::float32;
};

/// @throws Error  for an unknown key or a value out of range.
FitOptions fit_options(const Settings& parameters);
/// Lines "name = default   meaning".
std::string parameter_help();
/// Every parameter, as canonical JSON.
std::string to_json(const FitOptions& options);

/// @throws Error  naming view, light and texel of a value that is not finite and >= 0.
Model fit(const Btf& btf, const FitOptions& options, Progress& progress);

}  // namespace weft::laplacian
