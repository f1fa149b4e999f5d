#include "codecs/cmf/cmf.h"

#include "codecs/cmf/cmf_file.h"
#include "codecs/cmf/cmf_representation.h"
#include "codecs/cmf/fit.h"

namespace weft {

namespace cmf {

void CmfRepresentation::save(const std::filesystem::path& folder) const {
  write_model(folder, model_);
}

}  // namespace cmf

Codec cmf_codec() {
  return {
      .name = "cmf",
      .summary = "chained matrix factorisation: maps over light, half-vector and view, clustered",
      .reference = "paper 004, sections 4 and 5; docs/codecs/cmf.md",
      .parameters = cmf::parameter_help(),
      .fit = [](std::shared_ptr<const Btf> btf, const Settings& parameters,
                Progress& progress) -> std::unique_ptr<Representation> {
        const cmf::FitOptions options = cmf::fit_options(parameters);
        return std::make_unique<cmf::CmfRepresentation>(cmf::fit(*btf, options, progress));
      },
      .load = [](const std::filesystem::path& folder) -> std::unique_ptr<Representation> {
        return std::make_unique<cmf::CmfRepresentation>(cmf::read_model(folder));
      }};
}

}  // namespace weft
