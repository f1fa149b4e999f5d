// Fits a PCA's model: of the whole matrix, or of each view's.
#pragma once

#include "btf/btf.h"
#include "btf/progress.h"
#include "codecs/pca/model.h"
#include "codecs/truncated_svd.h"
#include "settings/settings.h"

namespace weft::pca {

struct FitOptions {
  std::size_t components = 16;
  Storage storage = Storage::half;
};

/// @throws Error  for an unknown key or a value out of range.
FitOptions fit_options(const Settings& parameters, std::size_t default_components);
/// Lines "name = default   meaning".
std::string parameter_help(std::size_t default_components);
/// Every parameter, as canonical JSON.
std::string to_json(const FitOptions& options);

/// A model without components and mean, to be filled set by set.
Model empty_model(const Btf& btf, const std::string& codec, std::size_t sets,
                  const FitOptions& options);

/// A texel a row, a column for [view][light][rgb] of the views from `first_view` on: what the
/// components of one set are made of.
RowSource abrdf_rows(const Btf& btf, std::size_t first_view, std::size_t views);

/// Writes `svd` (of `abrdf_rows` of the set's views) as set `set`. Sets may be stored side by side.
void store_set(const TruncatedSvd& svd, std::size_t set, std::size_t first_view, Model& model);

/// Divides all means by their largest, and rounds them. The last step.
void store_means(Model& model);

}  // namespace weft::pca
