#include "acquisition/indirect_cache.h"

#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <span>

#include "acquisition/path_block.h"
#include "btf/error.h"

namespace weft {

namespace {

constexpr double most_bytes = 1e9;

// Of each cell: together four times as many as one view's, as all views share their noise.
int paths_a_cell(const TraceSettings& s, std::size_t cells) {
  constexpr double views_worth = 4;
  const double paths = views_worth * s.width * s.height * s.spp / static_cast<double>(cells);
  return static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::clamp(paths, 4.0, 4096.0))));
}

}  // namespace

std::optional<std::string> IndirectCache::obstacle(const Mesostructure& mesostructure) {
  if (!mesostructure.curves.segments.empty()) return "the structure has fibres";
  for (std::size_t m = 0; m < mesostructure.materials.size(); ++m) {
    if (mesostructure.materials[m].kind() != Bsdf::Kind::lambert)
      return fmt::format("material '{}' is not of type lambert",
                         mesostructure.mesh.material_names[m]);
  }
  return std::nullopt;
}

IndirectCache::IndirectCache(const ViewTracer& tracer)
    : groups_(tracer.lights().groups()), cells_(tracer.facets()) {
  if (const auto obstacle = IndirectCache::obstacle(tracer.mesostructure())) {
    throw bad_input("--indirect cache",
                    "keeps what triangles reflect alike to everywhere; " + *obstacle,
                    "use --indirect traced");
  }
  const double bytes = static_cast<double>(cells_.count() * groups_ * sizeof(RgbLanes));
  if (bytes > most_bytes) {
    throw bad_input("--indirect cache",
                    fmt::format("would take {:.1f} GB; at most 1 is possible", bytes / 1e9),
                    "use --indirect traced, or fewer lights or facets");
  }
  const std::vector<Cell> cells = cells_.all();
  values_.resize(cells.size() * groups_);
  const std::size_t at_once = PathBlock::texels_for(tracer.lights().size());
  const int paths = paths_a_cell(tracer.settings(), cells.size());
  const std::size_t blocks = (cells.size() + at_once - 1) / at_once;
  std::vector<std::int64_t> rays(blocks);
  tbb::enumerable_thread_specific<PathBlock> workers([&] { return PathBlock(tracer); });
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    PathBlock& block = workers.local();
    const std::size_t first = b * at_once;
    const std::size_t count = std::min(at_once, cells.size() - first);
    block.trace_indirect(std::span(cells).subspan(first, count), first, paths);
    rays[b] = block.statistics().rays();
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t l = 0; l < tracer.lights().size(); ++l) {
        RgbLanes& value = values_[(first + i) * groups_ + l / lanes];
        const auto lane = static_cast<int>(l % lanes);
        // A wrong answer's correction may leave a mean below zero.
        value.r[lane] = static_cast<float>(std::max(0.0, block.sums().mean(i, l, 0)));
        value.g[lane] = static_cast<float>(std::max(0.0, block.sums().mean(i, l, 1)));
        value.b[lane] = static_cast<float>(std::max(0.0, block.sums().mean(i, l, 2)));
      }
    }
  });
  for (const std::int64_t r : rays) rays_ += r;
}

}  // namespace weft
