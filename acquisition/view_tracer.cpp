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

namespace weft {

namespace {

constexpr double lowest_theta = 89.9;  // degrees

}  // namespace

TraceStatistics& TraceStatistics::operator+=(const TraceStatistics& other) {
  paths += other.paths;
  primary_rays += other.primary_rays;
  bounce_rays += other.bounce_rays;
  shadow_rays += other.shadow_rays;
  visibility_queries += other.visibility_queries;
  answers_checked += other.answers_checked;
  wrong_answers += other.wrong_answers;
  negative += other.negative;
  rays_traced_on += other.rays_traced_on;
  missed += other.missed;
  degenerate += other.degenerate;
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
constexpr double paths_a_ray = 2;
constexpr double table_bytes = 512e6;

VisibilityTable table_for(const std::vector<Facet>& facets, const LightSet& lights,
                          const PeriodicScene& scene, const TraceSettings& s) {
  const auto cells = static_cast<double>(VisibilityTable::cells_of(facets));
  const double paths = static_cast<double>(s.views) * s.width * s.height * s.spp;
  const double bytes =
      cells * static_cast<double>(lights.groups() * sizeof(VisibilityTable::Answer));
  const int rays = static_cast<int>(std::min(4.0, paths / (paths_a_ray * cells)));
  if (rays < 1 || bytes > table_bytes) return {facets, lights};
  return {facets, lights, scene, rays};
}

}  // namespace

ViewTracer::ViewTracer(Mesostructure mesostructure, std::vector<Direction> lights,
                       TraceSettings settings)
    : mesostructure_(std::move(mesostructure)),
      lights_(std::move(lights)),
      settings_(settings),
      scene_(mesostructure_.mesh),
      facets_(facets_of(mesostructure_.mesh)),
      visibility_(table_for(facets_, lights_, scene_, settings_)) {
  check_elevations(lights_.directions(), "light");
  if (settings_.spp < 1)
    throw bad_input("--spp", fmt::format("is {}; expected at least 1", settings_.spp));
  if (settings_.width < 1 || settings_.height < 1) {
    throw bad_input("--texels", fmt::format("is {} x {}; expected at least 1", settings_.width,
                                            settings_.height));
  }
  if (settings_.max_bounces < 0) {
    throw bad_input("--max-bounces",
                    fmt::format("is {}; expected at least 0", settings_.max_bounces));
  }
}

TracedView ViewTracer::trace(const Direction& view, std::uint64_t view_key) const {
  check_elevations({&view, 1}, "view");
  const int edge = PathBlock::edge_for(lights_.size());
  const int columns = (settings_.width + edge - 1) / edge;
  const int rows = (settings_.height + edge - 1) / edge;
  const std::size_t texels = static_cast<std::size_t>(settings_.width) * settings_.height;
  const auto blocks = static_cast<std::size_t>(columns) * rows;
  const bool with_errors = settings_.spp > 1;
  TracedView traced;
  traced.values.resize(3 * lights_.size() * texels);
  std::vector<std::vector<double>> variances(blocks);  // of each light's sum over the block
  std::vector<TraceStatistics> statistics(blocks);
  tbb::enumerable_thread_specific<PathBlock> workers([&] { return PathBlock(*this); });
  const auto trace_block = [&](std::size_t b) {
    PathBlock& block = workers.local();
    const int left = static_cast<int>(b) % columns * edge;
    const int top = static_cast<int>(b) / columns * edge;
    block.trace(view, view_key, left, top);
    variances[b].resize(lights_.size());
    for (std::size_t l = 0; l < lights_.size(); ++l) {
      for (int y = 0; y < block.rows(); ++y) {
        float* out =
            &traced.values[3 * (l * texels + static_cast<std::size_t>(top + y) * settings_.width +
                                static_cast<std::size_t>(left))];
        for (int x = 0; x < block.columns(); ++x, out += 3) {
          const auto texel = static_cast<std::size_t>(y) * block.columns() + x;
          for (int c = 0; c < 3; ++c) {
            const double mean = block.mean(texel, l, c);
            out[c] = mean < 0 ? 0.0F : static_cast<float>(mean);
            statistics[b].negative += mean < 0 ? 1 : 0;
          }
          if (with_errors) variances[b][l] += block.grey_variance(texel, l);
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
