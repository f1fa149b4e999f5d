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

ViewTracer::ViewTracer(Mesostructure mesostructure, std::vector<Direction> lights,
                       TraceSettings settings)
    : mesostructure_(std::move(mesostructure)),
      lights_(std::move(lights)),
      settings_(settings),
      scene_(mesostructure_.mesh) {
  check_elevations(lights_, "light");
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

namespace {

// From the sums of groups of samples over the whole tile: the spread of their means.
std::vector<float> standard_errors(const std::vector<double>& group_sums, std::size_t n_lights,
                                   int spp, double texels) {
  if (spp < 2) return {};
  const int groups = std::min(PathBlock::error_groups, spp);
  std::vector<float> errors(n_lights);
  for (std::size_t l = 0; l < n_lights; ++l) {
    double sum = 0;
    double sum_of_squares = 0;
    for (int g = 0; g < groups; ++g) {
      const int samples =
          spp / PathBlock::error_groups + (g < spp % PathBlock::error_groups ? 1 : 0);
      const double mean =
          group_sums[static_cast<std::size_t>(g) * n_lights + l] / (samples * texels);
      sum += mean;
      sum_of_squares += mean * mean;
    }
    const double variance = std::max(0.0, sum_of_squares - sum * sum / groups) / (groups - 1);
    errors[l] = static_cast<float>(std::sqrt(variance / groups));
  }
  return errors;
}

}  // namespace

TracedView ViewTracer::trace(const Direction& view, std::uint64_t view_key) const {
  check_elevations({&view, 1}, "view");
  const int columns = (settings_.width + PathBlock::edge - 1) / PathBlock::edge;
  const int rows = (settings_.height + PathBlock::edge - 1) / PathBlock::edge;
  const std::size_t texels = static_cast<std::size_t>(settings_.width) * settings_.height;
  const auto blocks = static_cast<std::size_t>(columns) * rows;
  TracedView traced;
  traced.values.resize(3 * lights_.size() * texels);
  std::vector<std::vector<double>> group_sums(blocks);
  std::vector<TraceStatistics> statistics(blocks);
  tbb::enumerable_thread_specific<PathBlock> workers([&] { return PathBlock(*this); });
  const auto trace_block = [&](std::size_t b) {
    PathBlock& block = workers.local();
    const int left = static_cast<int>(b) % columns * PathBlock::edge;
    const int top = static_cast<int>(b) / columns * PathBlock::edge;
    block.trace(view, view_key, left, top);
    for (int y = top; y < std::min(top + PathBlock::edge, settings_.height); ++y) {
      for (int x = left; x < std::min(left + PathBlock::edge, settings_.width); ++x) {
        const auto texel = static_cast<std::size_t>((y - top) * PathBlock::edge + x - left);
        for (std::size_t l = 0; l < lights_.size(); ++l) {
          const Imath::V3d mean = block.sum(texel, l) / settings_.spp;
          float* out =
              &traced.values[3 * (l * texels + static_cast<std::size_t>(y) * settings_.width + x)];
          for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(mean[c]);
        }
      }
    }
    group_sums[b] = block.group_sums();
    statistics[b] = block.statistics();
  };
  // Isolated: a thread that waits here must not begin another view, whose memory would come on top.
  // With a context of its own: where another view fails, TBB would otherwise cancel this one's
  // blocks in silence.
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::this_task_arena::isolate(
      [&] { tbb::parallel_for(std::size_t{0}, blocks, trace_block, context); });
  std::vector<double> sums(PathBlock::error_groups * lights_.size());
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += group_sums[b][i];
    traced.statistics += statistics[b];
  }
  traced.standard_errors =
      standard_errors(sums, lights_.size(), settings_.spp, static_cast<double>(texels));
  return traced;
}

}  // namespace weft
