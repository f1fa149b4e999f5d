#include "codecs/hf/hf.h"

#include "codecs/factor_maps/factor_map_representation.h"
#include "codecs/factor_maps/model_file.h"
#include "codecs/hf/fit.h"

namespace weft {

Codec hf_codec() {
  using factor_maps::FactorMapRepresentation;
  return {
      .name = "hf",
      .summary = "homomorphic factorisation: maps over light, half-vector and view from logarithms",
      .reference = "McCool et al. 2001 as in paper 004, section 4.3; docs/codecs/hf.md",
      .parameters = hf::parameter_help(),
      .fit = [](std::shared_ptr<const Btf> btf, const Settings& parameters,
                Progress& progress) -> std::unique_ptr<Representation> {
        const hf::FitOptions options = hf::fit_options(parameters);
        return std::make_unique<FactorMapRepresentation>(hf::fit(btf, options, progress));
      },
      .load = [](const std::filesystem::path& folder) -> std::unique_ptr<Representation> {
        return std::make_unique<FactorMapRepresentation>(factor_maps::read_model(folder, "hf"));
      }};
}

}  // namespace weft
