#include "codecs/laplacian/laplacian.h"

#include "codecs/laplacian/fit.h"
#include "codecs/laplacian/laplacian_representation.h"

namespace weft {

Codec laplacian_codec() {
  return {
      .name = "laplacian",
      .summary = "levels of detail: PCA of each level of the images' Laplacian pyramids",
      .reference = "paper 000; docs/codecs/laplacian.md",
      .parameters = laplacian::parameter_help(),
      .fit = [](std::shared_ptr<const Btf> btf, const Settings& parameters,
                Progress& progress) -> std::unique_ptr<Representation> {
        const laplacian::FitOptions options = laplacian::fit_options(parameters);
        return std::make_unique<laplacian::LaplacianRepresentation>(
            laplacian::fit(*btf, options, progress));
      },
      .load = [](const std::filesystem::path& folder) -> std::unique_ptr<Representation> {
        return std::make_unique<laplacian::LaplacianRepresentation>(laplacian::read_model(folder));
      }};
}

}  // namespace weft
