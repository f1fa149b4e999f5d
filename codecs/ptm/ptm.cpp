#include "codecs/ptm/ptm.h"

#include "codecs/ptm/fit.h"
#include "codecs/reflectance_fields/representation.h"

namespace weft {

Codec ptm_codec() {
  using reflectance_fields::FieldRepresentation;
  return {
      .name = "ptm",
      .summary = "polynomial texture maps: a biquadratic of the light for each view and texel",
      .reference = "Malzbender et al., SIGGRAPH 2001; paper 003; docs/codecs/ptm.md",
      .parameters = ptm::parameter_help(),
      .fit = [](std::shared_ptr<const Btf> btf, const Settings& parameters,
                Progress& progress) -> std::unique_ptr<Representation> {
        const ptm::FitOptions options = ptm::fit_options(parameters);
        return std::make_unique<FieldRepresentation>(ptm::fit(*btf, options, progress));
      },
      .load = [](const std::filesystem::path& folder) -> std::unique_ptr<Representation> {
        return std::make_unique<FieldRepresentation>(reflectance_fields::read_model(folder, "ptm"));
      },
      .fit_bytes_a_texel_and_view = reflectance_fields::fit_bytes_a_field};
}

}  // namespace weft
