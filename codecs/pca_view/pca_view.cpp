#include "codecs/pca_view/pca_view.h"

#include <tbb/parallel_for.h>

#include "codecs/pca/fit.h"
#include "codecs/pca/pca_representation.h"
#include "codecs/sample_check.h"

namespace weft {

namespace {

constexpr std::size_t default_components = 4;

pca::Model fitted(const Btf& btf, const pca::FitOptions& options, Progress& progress) {
  refuse_invalid_samples(btf);
  const std::size_t n_views = btf.views().size();
  progress.start(static_cast<std::int64_t>(n_views), "views");
  pca::Model model = pca::empty_model(btf, "pca-view", n_views, options);
  TruncatedSvdOptions svd;
  svd.components = model.components;
  svd.centred = true;
  for_some_views(btf, [&](std::size_t first, const Btf& part) {
    tbb::parallel_for(std::size_t{0}, part.views().size(), [&](std::size_t v) {
      const std::size_t view = first + v;
      pca::store_set(truncated_svd(pca::abrdf_rows(part, v, 1), svd), view, view, model);
      progress.advance(1);
    });
  });
  pca::store_means(model);
  progress.finish();
  return model;
}

}  // namespace

Codec pca_view_codec() {
  return {.name = "pca-view",
          .summary = "principal components of each view: eigen-images over the lights",
          .reference = "Sattler, Sarlette and Klein, EGSR 2003; docs/codecs/pca-view.md",
          .parameters = pca::parameter_help(default_components),
          .fit = [](std::shared_ptr<const Btf> btf, const Settings& parameters,
                    Progress& progress) -> std::unique_ptr<Representation> {
            const pca::FitOptions options = pca::fit_options(parameters, default_components);
            return std::make_unique<pca::PcaRepresentation>(fitted(*btf, options, progress));
          },
          .load = [](const std::filesystem::path& folder) -> std::unique_ptr<Representation> {
            return std::make_unique<pca::PcaRepresentation>(pca::read_model(folder, "pca-view"));
          },
          .fit_bytes_a_texel_and_view = 96};  // of default_components weights, three or four times
}

}  // namespace weft
