#include "codecs/lobes/lobes.h"

#include "codecs/lobes/fit.h"
#include "codecs/reflectance_fields/representation.h"

namespace weft {

Codec lobes_codec() {
  using reflectance_fields::FieldRepresentation;
  return {.name = "lobes",
          .summary = "reflectance fields: a few lobes of the light for each view and texel",
          .reference = "Meseth, Müller and Klein 2003, paper 003; docs/codecs/lobes.md",
          .parameters = lobes::parameter_help(),
          .fit = [](std::shared_ptr<const Btf> btf, const Settings& parameters,
                    Progress& progress) -> std::unique_ptr<Representation> {
            const lobes::FitOptions options = lobes::fit_options(parameters);
            return std::make_unique<FieldRepresentation>(lobes::fit(*btf, options, progress));
          },
          .load = [](const std::filesystem::path& folder) -> std::unique_ptr<Representation> {
            return std::make_unique<FieldRepresentation>(
                reflectance_fields::read_model(folder, "lobes"));
          },
          .fit_bytes_a_texel_and_view = reflectance_fields::fit_bytes_a_field};
}

}  // namespace weft
