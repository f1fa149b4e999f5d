#include "codecs/srbf/srbf.h"

#include "codecs/srbf/fit.h"
#include "codecs/srbf/srbf_representation.h"

namespace weft {

Codec srbf_codec() {
  return {.name = "srbf",
          .summary = "sums of spherical Gaussians of fitted variables, at every mip level",
          .reference = "paper 001; docs/codecs/srbf.md",
          .parameters = srbf::parameter_help(),
          .fit = [](std::shared_ptr<const Btf> btf, const Settings& parameters,
                    Progress& progress) -> std::unique_ptr<Representation> {
            const srbf::FitOptions options = srbf::fit_options(parameters);
            return std::make_unique<srbf::SrbfRepresentation>(srbf::fit(*btf, options, progress));
          },
          .load = [](const std::filesystem::path& folder) -> std::unique_ptr<Representation> {
            return std::make_unique<srbf::SrbfRepresentation>(srbf::read_model(folder));
          },
          .fit_bytes_a_texel = 10240};  // three or four times the 243 doubles of its kernels
}

}  // namespace weft
