#include "acquisition/open_trial.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <tuple>
#include <utility>

#include "btf/random.h"
#include "tracer/frame.h"

namespace weft {

namespace {

constexpr std::uint64_t trial_key = 0x4F50454E;  // for its random numbers
// Pairs of random numbers of a ray.
constexpr std::uint64_t trial_place = 0;
constexpr std::uint64_t trial_direction = 1;

std::array<float, 2> random_pair(std::size_t ray, std::uint64_t pair) {
  const std::uint64_t bits = hash_coordinates(trial_key, ray, pair);
  return {unit_float(bits), unit_float(bits << 32)};
}

// Entry f: the area of facets 0 to f together.
std::vector<double> areas_up_to(const std::vector<Facet>& facets) {
  std::vector<double> areas;
  areas.reserve(facets.size());
  double sum = 0;
  for (const Facet& facet : facets) {
    if (!facet.degenerate()) sum += (facet.edge_u % facet.edge_v).length() / 2.0;
    areas.push_back(sum);
  }
  return areas;
}

OpenTrial operator+(const OpenTrial& a, const OpenTrial& b) {
  return {a.open + b.open, a.met + b.met};
}

}  // namespace

OpenTrial try_open_rays(const std::vector<Facet>& facets, const VisibilityTable& table,
                        const PeriodicScene& scene, std::size_t rays) {
  const std::vector<double> areas = areas_up_to(facets);
  if (areas.empty() || !(areas.back() > 0) || !std::isfinite(areas.back())) return {};
  const auto try_packet = [&](std::size_t first) {
    HitPacket packet{};
    unsigned open = 0;
    for (std::size_t i = first; i < std::min(first + lanes, rays); ++i) {
      // Even in steps along the facets, so that each gets its share.
      const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(rays) * areas.back();
      const auto f =
          static_cast<std::uint32_t>(std::ranges::upper_bound(areas, at) - areas.begin());
      const Facet& facet = facets[f];
      auto [u, v] = random_pair(i, trial_place);
      if (u + v > 1) std::tie(u, v) = std::pair(1 - u, 1 - v);
      const auto [a, b] = random_pair(i, trial_direction);
      const Direction on = frame_around(facet.normal).to_world(cosine_direction(a, b));
      if (!table.is_open(table.at(f, u, v), on)) continue;
      packet.ray.set(i - first, ray_origin(facet.point(u, v), facet.normal), on);
      open |= 1U << (i - first);
    }
    if (open == 0) return OpenTrial{};
    scene.intersect(packet, static_cast<std::uint16_t>(open), Coherence::incoherent);
    OpenTrial trial{.open = std::popcount(open), .met = 0};
    for (unsigned left = open; left != 0; left &= left - 1)
      trial.met += packet.mesh[std::countr_zero(left)] != RayHit::none ? 1 : 0;
    return trial;
  };
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, (rays + lanes - 1) / lanes), OpenTrial{},
      [&](const tbb::blocked_range<std::size_t>& range, OpenTrial sum) {
        for (std::size_t p = range.begin(); p < range.end(); ++p) sum = sum + try_packet(p * lanes);
        return sum;
      },
      [](const OpenTrial& a, const OpenTrial& b) { return a + b; });
}

}  // namespace weft
