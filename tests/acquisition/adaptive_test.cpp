// Stopping a texel where its error is small enough: the error that is reached, what it costs, and
// the bias.
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "acquisition/view_tracer.h"
#include "btf/hemisphere_sampling.h"
#include "tests/acquisition/known_structures.h"

using namespace weft;

namespace {

constexpr int size = 8;
constexpr std::size_t texels = static_cast<std::size_t>(size) * size;

ViewTracer tracer_of(const Mesostructure& structure, int spp, double error) {
  return {
      structure,
      named_directions("fibonacci:16"),
      {.width = size, .height = size, .spp = spp, .max_bounces = 4, .views = 1000, .error = error}};
}

// Mean of RGB, [light][texel].
std::vector<double> grey(const TracedView& traced) {
  std::vector<double> result(traced.values.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = (static_cast<double>(traced.values[3 * i]) + traced.values[3 * i + 1] +
                 traced.values[3 * i + 2]) /
                3;
  return result;
}

struct Runs {
  std::vector<double> mean;      // [light][texel]
  std::vector<double> variance;  // of one run
  double spp = 0;                // in the mean
  double unsettled = 0;          // share of texels
};

Runs run(const ViewTracer& tracer, const Direction& view, int count, std::uint64_t first_key) {
  Runs runs;
  std::vector<double> squares;
  TraceStatistics statistics;
  for (int i = 0; i < count; ++i) {
    const TracedView traced = tracer.trace(view, first_key + static_cast<std::uint64_t>(i));
    const std::vector<double> values = grey(traced);
    runs.mean.resize(values.size());
    squares.resize(values.size());
    for (std::size_t k = 0; k < values.size(); ++k) {
      runs.mean[k] += values[k] / count;
      squares[k] += values[k] * values[k] / count;
    }
    statistics += traced.statistics;
  }
  for (std::size_t k = 0; k < squares.size(); ++k)
    runs.variance.push_back(std::max(0.0, squares[k] - runs.mean[k] * runs.mean[k]) * count /
                            (count - 1));
  REQUIRE(statistics.texels == static_cast<std::int64_t>(texels) * count);
  runs.spp = static_cast<double>(statistics.paths) / static_cast<double>(statistics.texels);
  runs.unsettled =
      static_cast<double>(statistics.unsettled) / static_cast<double>(statistics.texels);
  return runs;
}

// What --error speaks of, from true means: max(m, 1e-3 of the largest m) a light.
std::vector<double> scales_of(const std::vector<double>& mean) {
  std::vector<double> scales;
  for (std::size_t first = 0; first < mean.size(); first += texels) {
    const auto begin = mean.begin() + static_cast<std::ptrdiff_t>(first);
    scales.push_back(std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(texels), 0.0) /
                     static_cast<double>(texels));
  }
  const double largest = *std::ranges::max_element(scales);
  for (double& scale : scales) scale = std::max(scale, 1e-3 * largest);
  return scales;
}

// Root mean square over lights and texels of sqrt(variance) over the light's scale.
double relative_error(const Runs& runs, const std::vector<double>& scales) {
  double sum = 0;
  for (std::size_t k = 0; k < runs.variance.size(); ++k)
    sum += runs.variance[k] / std::pow(scales[k / texels], 2);
  return std::sqrt(sum / static_cast<double>(runs.variance.size()));
}

const Direction view = from_spherical(0.9, 4.0);

}  // namespace

TEST_CASE("a target error is reached, and not undercut by more than half", "[heavy]") {
  // Undercut, as groups of samples are stratified among each other, and smooth texels have less
  // error after the first 16 samples already.
  const std::vector<double> scales =
      scales_of(run(tracer_of(test::checker(64), 4096, 0), view, 2, 0).mean);
  double earlier = 0;
  for (const double target : {0.1, 0.05, 0.025}) {
    const Runs runs = run(tracer_of(test::checker(64), 1 << 16, target), view, 32, 100);
    const double reached = relative_error(runs, scales);
    INFO("target " << target << ": reached " << reached << " with " << runs.spp << " spp");
    CHECK(reached < 1.1 * target);
    CHECK(reached > target / 2);
    CHECK(runs.unsettled == 0);
    CHECK(runs.spp > 2 * earlier);
    earlier = runs.spp;
  }
}

TEST_CASE("fewer samples go where it is smooth, and 16 at least") {
  // Nothing shadows a plane: its 16 samples settle it (and 4 told how bright it is).
  const Runs flat = run(tracer_of(test::flat(Rgb(0.5F)), 1024, 0.01), view, 2, 0);
  CHECK(flat.spp == 20);
  CHECK(flat.unsettled == 0);
  const Runs checker = run(tracer_of(test::checker(64), 1024, 0.01), view, 2, 0);
  CHECK(checker.spp > 40);
  // Half of the tile is a plane that nothing shadows, the rest pits that no 1024 samples settle.
  const auto bumps = [](double x, double y) {
    const double s = y > 0.5 ? std::sin(40 * x) * std::sin(4 * std::numbers::pi * y) : 0;
    return -0.1 * std::abs(s);
  };
  const Mesostructure half =
      test::structure(test::height_field(128, bumps, [](double, double) { return 0; }),
                      {Bsdf::lambert(Rgb(0.8F))}, 0);
  const TracedView traced = tracer_of(half, 1024, 0.01).trace({0, 0, 1}, 0);
  CHECK(traced.statistics.paths > 100 * static_cast<std::int64_t>(texels));
  CHECK(traced.statistics.paths < 700 * static_cast<std::int64_t>(texels));
}

TEST_CASE("texels that all samples do not settle are counted") {
  const Runs few = run(tracer_of(test::checker(64), 16, 1e-4), view, 1, 0);
  CHECK(few.spp == 20);
  CHECK(few.unsettled == 1);
  const Runs some = run(tracer_of(test::checker(64), 64, 0.03), view, 4, 0);
  CHECK(some.unsettled > 0.02);
  CHECK(some.unsettled < 0.98);
  CHECK(some.spp < 68);
}

TEST_CASE("stopping early is biased by less than a tenth of the target in the mean", "[slow]") {
  // Mean over many runs against many samples; the tile's mean, and texel by texel as far as the
  // noise of the runs lets see.
  const std::string scenes = std::string(WEFT_SOURCE_DIR) + "/scenes/mesostructures/";
  for (const std::string name : {"checker_lambert", "checker"}) {
    const Mesostructure structure =
        read_mesostructure(scenes + name + ".toml", std::vector<std::string>{"resolution=64"});
    const Runs fixed = run(tracer_of(structure, 4096, 0), view, 16, 0);
    const std::vector<double> scales = scales_of(fixed.mean);
    for (const double target : {0.08, 0.04, 0.02, 0.01}) {
      const int count = target < 0.02 ? 64 : 256;
      const Runs runs = run(tracer_of(structure, 1 << 16, target), view, count, 1000);
      double bias = 0;
      double square = 0;
      double noise = 0;
      for (std::size_t k = 0; k < runs.mean.size(); ++k) {
        const double d = (runs.mean[k] - fixed.mean[k]) / scales[k / texels];
        bias += d / static_cast<double>(runs.mean.size());
        square += d * d / static_cast<double>(runs.mean.size());
        noise += (runs.variance[k] / count + fixed.variance[k] / 16) /
                 std::pow(scales[k / texels], 2) / static_cast<double>(runs.mean.size());
      }
      INFO(name << ", target " << target << ", reached " << relative_error(runs, scales) << " with "
                << runs.spp << " spp, " << 100 * runs.unsettled
                << " % unsettled: the tile's mean is off by " << bias << ", a texel by "
                << std::sqrt(std::max(0.0, square - noise)) << " (noise " << std::sqrt(noise)
                << ")");
      CHECK(std::abs(bias) < 0.1 * target);
      CHECK(square - noise < std::pow(0.25 * target, 2));
    }
  }
}
