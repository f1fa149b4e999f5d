#include "codecs/cmf/fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "codecs/cmf/anisotropy.h"
#include "codecs/factor_maps/rotation.h"

namespace weft::cmf {

using factor_maps::FittedFactors;
using factor_maps::Projection;
using factor_maps::texels_a_block;
using factor_maps::TexelSource;
using factor_maps::turned_back;

namespace {

FittedFactors empty_factors(const TexelSource& source, const FitOptions& options) {
  FittedFactors fitted(source, options.storage);
  const ChainOptions& chain = options.chain;
  const int half_terms = chain.difference ? chain.terms : 1;
  fitted.add(Projection::light, chain.terms);
  if (chain.half) fitted.add(Projection::half, half_terms);
  if (chain.difference) fitted.add(Projection::difference, half_terms);
  fitted.add(Projection::view, chain.terms);
  return fitted;
}

void factorise(const TexelSource& source, const Chain& chain, std::span<const std::size_t> texels,
               FittedFactors& fitted, Progress& progress) {
  const std::size_t blocks = (texels.size() + texels_a_block - 1) / texels_a_block;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const std::size_t first = block * texels_a_block;
    const auto part =
        texels.subspan(first, std::min<std::size_t>(texels_a_block, texels.size() - first));
    const std::vector<FactorMaps> maps = chain.factorise(source.block(part));
    for (std::size_t f = 0; f < maps.size(); ++f) store(maps[f].maps, part, f, fitted);
    progress.advance(static_cast<std::int64_t>(part.size()));
  });
}

}  // namespace

factor_maps::Model fit(const std::shared_ptr<const Btf>& btf, const FitOptions& options,
                       Progress& progress) {
  const TexelSource source(btf, options.storage.levels);
  FittedFactors fitted = empty_factors(source, options);
  if (options.rotate) fitted.rotation = greatest_anisotropy(source);
  progress.start(static_cast<std::int64_t>(source.size()), "texels");
  for (int rotation = 0; rotation < factor_maps::rotation_steps; ++rotation) {
    std::vector<std::size_t> texels;
    for (std::size_t t = 0; t < source.size(); ++t) {
      if ((options.rotate ? fitted.rotation[t] : 0) == rotation) texels.push_back(t);
    }
    if (texels.empty()) continue;
    // All texels of one rotation see the same, turned, directions.
    const Chain chain(turned_back(btf->lights(), rotation), turned_back(btf->views(), rotation),
                      options.chain);
    // The data itself before its mip levels, which inherit what is wrong with it.
    const std::size_t finest =
        std::ranges::lower_bound(
            texels, source.levels().size() > 1 ? source.levels()[1].first : source.size()) -
        texels.begin();
    factorise(source, chain, std::span(texels).first(finest), fitted, progress);
    factorise(source, chain, std::span(texels).subspan(finest), fitted, progress);
  }
  return assemble(source, std::move(fitted), options.storage, "cmf", to_json(options), progress);
}

}  // namespace weft::cmf
