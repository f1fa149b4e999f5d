#include "codecs/pca/pca.h"

#include "codecs/pca/fit.h"
#include "codecs/pca/pca_representation.h"
#include "codecs/sample_check.h"

namespace weft {

namespace {

constexpr std::size_t default_components = 16;

pca::Model fitted(const Btf& btf, const pca::FitOptions& options, Progress& progress) {
  refuse_invalid_samples(btf);
  progress.start(1, "matrices");
  pca::Model model = pca::empty_model(btf, "pca", 1, options);
  TruncatedSvdOptions svd;
  svd.components = model.components;
  svd.centred = true;
  pca::store_set(truncated_svd(pca::abrdf_rows(btf, 0, btf.views().size()), svd), 0, 0, model);
  pca::store_means(model);
  progress.advance(1);
  progress.finish();
  return model;
}

}  // namespace

Codec pca_codec() {
  return {.name = "pca",
          .summary = "principal components of the whole BTF: eigen-ABRDFs and texel weights",
          .reference = "Koudelka et al., Texture 2003; docs/codecs/pca.md",
          .parameters = pca::parameter_help(default_components),
          .fit = [](std::shared_ptr<const Btf> btf, const Settings& parameters,
                    Progress& progress) -> std::unique_ptr<Representation> {
            const pca::FitOptions options = pca::fit_options(parameters, default_components);
            return std::make_unique<pca::PcaRepresentation>(fitted(*btf, options, progress));
          },
          .load = [](const std::filesystem::path& folder) -> std::unique_ptr<Representation> {
            return std::make_unique<pca::PcaRepresentation>(pca::read_model(folder, "pca"));
          }};
}

}  // namespace weft
