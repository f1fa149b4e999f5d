#include "acquisition/view_tracer.h"

#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/path_block.h"
#include "btf/error.h"
#include "btf/random.h"

namespace weft {

namespace {

constexpr double lowest_theta = 89.9;  // degrees
constexpr int pilot_spp = 4;           // that tell how bright a pair is, see TraceSettings::error

}  // namespace

TraceStatistics& TraceStatistics::operator+=(const TraceStatistics& other) {
  texels += other.texels;
  paths += other.paths;
  primary_rays += other.primary_rays;
  bounce_rays += other.bounce_rays;
  open_bounces += other.open_bounces;
  open_checked += other.open_checked;
  open_wrong += other.open_wrong;
  shadow_rays += other.shadow_rays;
  table_rays += other.table_rays;
  cache_rays += other.cache_rays;
  visibility_queries += other.visibility_queries;
  answers_checked += other.answers_checked;
  wrong_answers += other.wrong_answers;
  negative += other.negative;
  rays_traced_on += other.rays_traced_on;
  missed += other.missed;
  degenerate += other.degenerate;
  unsettled += other.unsettled;
  trapped += other.trapped;
  invalid += other.invalid;
  return *this;
}

void check_elevations(std::span<const Direction> directions, const std::string& role) {
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double theta = degrees(theta_of(directions[i]));
    if (theta > lowest_theta + 1e-3) {
      throw bad_input(
          fmt::format("{} {}", role, i),
          fmt::format("is at theta {:.3f} degrees; expected at most {}", theta, lowest_theta));
    }
  }
}

namespace {

// The table is worth its rays where paths that each ask for every light are this many times those
// of the table.
constexpr double paths_a_ray = 1;
constexpr double table_bytes = 512e6;

VisibilityTable table_for(const std::vector<Facet>& facets, const LightSet& lights,
                          const PeriodicScene& scene, const TraceSettings& s) {
  FacetCells cells(facets);
  const double paths = static_cast<double>(s.views) * s.width * s.height * s.spp;
  const auto bytes =
      static_cast<double>(cells.count() * lights.groups() * sizeof(VisibilityTable::Answer));
  const double rays = paths / (paths_a_ray * static_cast<double>(cells.count()));
  if (!s.table || facets.empty() || rays < VisibilityTable::least_rays || bytes > table_bytes)
    return VisibilityTable(lights);
  return {facets, std::move(cells), lights, scene, static_cast<int>(std::min(rays, 1e3))};
}

std::vector<Direction> checked(std::vector<Direction> lights) {
  if (lights.empty()) throw bad_input("lights", "are none; expected at least one");
  check_elevations(lights, "light");
  return lights;
}

TraceSettings checked(const TraceSettings& s) {
  if (s.spp < 1) throw bad_input("--spp", fmt::format("is {}; expected at least 1", s.spp));
  if (s.width < 1 || s.height < 1) {
    throw bad_input("--texels", fmt::format("is {} x {}; expected at least 1", s.width, s.height));
  }
  if (s.error < 0) throw bad_input("--error", fmt::format("is {}; expected at least 0", s.error));
  if ((s.error > 0 || s.texel_errors) && s.spp < 2)
    throw bad_input("--spp", "is 1; expected at least 2, from whose spread an error can be told");
  if (s.max_bounces < 0) {
    throw bad_input("--max-bounces", fmt::format("is {}; expected at least 0", s.max_bounces));
  }
  return s;
}

}  // namespace

TraceableStructure::TraceableStructure(Mesostructure structure)
    : mesostructure(std::move(structure)),
      scene(mesostructure.mesh, mesostructure.curves),
      facets(facets_of(mesostructure.mesh)) {}

ViewTracer::ViewTracer(Mesostructure mesostructure, std::vector<Direction> lights,
                       TraceSettings settings)
    : ViewTracer(std::make_shared<const TraceableStructure>(std::move(mesostructure)),
                 std::move(lights), settings) {}

ViewTracer::ViewTracer(std::shared_ptr<const TraceableStructure> structure,
                       std::vector<Direction> lights, TraceSettings settings)
    : structure_(std::move(structure)),
      lights_(checked(std::move(lights))),
      settings_(checked(settings)),
      visibility_(table_for(facets(), lights_, scene(), settings_)) {
  if (settings_.indirect_cache && settings_.max_bounces > 0) indirect_cache_ = IndirectCache(*this);
}

TracedView ViewTracer::trace(const Direction& view, std::uint64_t view_key) const {
  check_elevations({&view, 1}, "view");
  if (!(settings_.error > 0)) return trace_blocks(view, view_key, settings_.spp, {});
  TracedView pilot = trace_blocks(view, mix_bits(view_key), pilot_spp, {});
  pilot.statistics.texels = 0;  // they are counted below
  TracedView traced = trace_blocks(view, view_key, settings_.spp, error_scales(pilot.values));
  traced.statistics += pilot.statistics;
  return traced;
}

// For each light max(m, 1e-3 of the largest m), m the tile's mean; ones where all is black.
std::vector<double> ViewTracer::error_scales(const std::vector<float>& values) const {
  constexpr double darkest = 1e-3;
  const std::size_t n = values.size() / lights_.size();
  std::vector<double> scales(lights_.size());
  for (std::size_t l = 0; l < lights_.size(); ++l) {
    for (std::size_t i = 0; i < n; ++i) scales[l] += values[l * n + i];
    scales[l] /= static_cast<double>(n);
  }
  const double largest = *std::ranges::max_element(scales);
  for (double& scale : scales) scale = largest > 0 ? std::max(scale, darkest * largest) : 1.0;
  return scales;
}

TracedView ViewTracer::trace_blocks(const Direction& view, std::uint64_t view_key, int spp,
                                    const std::vector<double>& error_scales) const {
  const int edge = PathBlock::edge_for(lights_.size());
  const int columns = (settings_.width + edge - 1) / edge;
  const int rows = (settings_.height + edge - 1) / edge;
  const std::size_t texels = static_cast<std::size_t>(settings_.width) * settings_.height;
  const auto blocks = static_cast<std::size_t>(columns) * rows;
  const bool with_errors = spp > 1;
  TracedView traced;
  traced.values.resize(3 * lights_.size() * texels);
  if (settings_.texel_errors) traced.texel_errors.resize(traced.values.size());
  if (settings_.cut_height) traced.coverage.resize(texels);
  std::vector<std::vector<double>> variances(blocks);  // of each light's sum over the block
  std::vector<TraceStatistics> statistics(blocks);
  tbb::enumerable_thread_specific<PathBlock> workers([&] { return PathBlock(*this); });
  const auto trace_block = [&](std::size_t b) {
    PathBlock& block = workers.local();
    const int left = static_cast<int>(b) % columns * edge;
    const int top = static_cast<int>(b) / columns * edge;
    block.trace(view, view_key, spp, error_scales, left, top);
    variances[b].resize(lights_.size());
    for (int y = 0; y < block.rows(); ++y) {
      for (int x = 0; x < block.columns(); ++x) {
        const auto texel = static_cast<std::size_t>(y) * block.columns() + x;
        const std::size_t place = static_cast<std::size_t>(top + y) * settings_.width +
                                  static_cast<std::size_t>(left + x);
        if (settings_.cut_height) traced.coverage[place] = block.coverage(texel);
        for (std::size_t l = 0; l < lights_.size(); ++l) {
          for (int c = 0; c < 3; ++c) {
            const std::size_t i = 3 * (l * texels + place) + static_cast<std::size_t>(c);
            const double mean = block.sums().mean(texel, l, c);
            statistics[b].negative += mean < 0 ? 1 : 0;
            traced.values[i] = mean < 0 ? 0.0F : static_cast<float>(mean);
            if (settings_.texel_errors)
              traced.texel_errors[i] =
                  static_cast<float>(std::sqrt(block.sums().variance(texel, l, c)));
          }
          if (with_errors) variances[b][l] += block.sums().grey_variance(texel, l);
        }
      }
    }
    statistics[b] += block.statistics();
  };
  // Isolated: a thread that waits here must not begin another view, whose memory would come on top.
  // With a context of its own: where another view fails, TBB would otherwise cancel this one's
  // blocks in silence.
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::this_task_arena::isolate(
      [&] { tbb::parallel_for(std::size_t{0}, blocks, trace_block, context); });
  for (const TraceStatistics& s : statistics) traced.statistics += s;
  if (!with_errors) return traced;
  // Texels draw their numbers apart from each other, so their variances add up.
  for (std::size_t l = 0; l < lights_.size(); ++l) {
    double sum = 0;
    for (std::size_t b = 0; b < blocks; ++b) sum += variances[b][l];
    traced.standard_errors.push_back(
        static_cast<float>(std::sqrt(sum) / static_cast<double>(texels)));
  }
  return traced;
}

}  // namespace weft
