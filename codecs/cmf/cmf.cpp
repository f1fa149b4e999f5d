#include "codecs/cmf/cmf.h"

#include "codecs/cmf/fit.h"
#include "codecs/factor_maps/factor_map_representation.h"
#include "codecs/factor_maps/model_file.h"

namespace weft {

Codec cmf_codec() {
  using factor_maps::FactorMapRepresentation;
  return {
      .name = "cmf",
      .summary = "chained matrix factorisation: maps over light, half-vector and view, clustered",
      .reference = "paper 004, sections 4 and 5; docs/codecs/cmf.md",
      .parameters = cmf::parameter_help(),
      .fit = [](std::shared_ptr<const Btf> btf, const Settings& parameters,
                Progress& progress) -> std::unique_ptr<Representation> {
        const cmf::FitOptions options = cmf::fit_options(parameters);
        return std::make_unique<FactorMapRepresentation>(cmf::fit(btf, options, progress));
      },
      .load = [](const std::filesystem::path& folder) -> std::unique_ptr<Representation> {
        return std::make_unique<FactorMapRepresentation>(factor_maps::read_model(folder, "cmf"));
      }};
}

}  // namespace weft
