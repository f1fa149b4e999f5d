#include "codecs/dfmf/dfmf.h"

#include "codecs/dfmf/dfmf_representation.h"
#include "codecs/dfmf/fit.h"

namespace weft {

Codec dfmf_codec() {
  return {.name = "dfmf",
          .summary = "decorrelated full-matrix factorisation: log-luminance and chromas apart",
          .reference = "the UBO2014 database's format; docs/codecs/dfmf.md",
          .parameters = dfmf::parameter_help(),
          .fit = [](std::shared_ptr<const Btf> btf, const Settings& parameters,
                    Progress& progress) -> std::unique_ptr<Representation> {
            const dfmf::FitOptions options = dfmf::fit_options(parameters);
            return std::make_unique<dfmf::DfmfRepresentation>(dfmf::fit(*btf, options, progress));
          },
          .load = [](const std::filesystem::path& folder) -> std::unique_ptr<Representation> {
            return std::make_unique<dfmf::DfmfRepresentation>(dfmf::read_model(folder));
          }};
}

}  // namespace weft
