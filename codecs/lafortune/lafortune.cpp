#include "codecs/lafortune/lafortune.h"

#include "codecs/lafortune/fit.h"
#include "codecs/lafortune/lafortune_representation.h"

namespace weft {

Codec lafortune_codec() {
  using lafortune::LafortuneRepresentation;
  return {
      .name = "lafortune",
      .summary = "a diffuse term and a few generalised cosine lobes a texel, all views together",
      .reference = "Lafortune et al., SIGGRAPH 1997; paper 003; docs/codecs/lafortune.md",
      .parameters = lafortune::parameter_help(),
      .fit = [](std::shared_ptr<const Btf> btf, const Settings& parameters,
                Progress& progress) -> std::unique_ptr<Representation> {
        const lafortune::FitOptions options = lafortune::fit_options(parameters);
        return std::make_unique<LafortuneRepresentation>(lafortune::fit(*btf, options, progress));
      },
      .load = [](const std::filesystem::path& folder) -> std::unique_ptr<Representation> {
        return std::make_unique<LafortuneRepresentation>(lafortune::read_model(folder));
      }};
}

}  // namespace weft
