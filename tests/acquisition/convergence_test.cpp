// How fast the error falls with the samples: faster than 1/sqrt(N) where the picture is smooth, and
// never slower.
//
// Each power of four of samples is traced with many seeds, which are dealt into groups. A group's
// root mean square error against a long run gives one slope in log-log; the spread of the groups'
// slopes is the error of their mean.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

#include "acquisition/view_tracer.h"
#include "tests/acquisition/known_structures.h"
#include "tests/statistics.h"

using namespace weft;

namespace {

constexpr double pi = std::numbers::pi;
constexpr std::array<int, 4> samples = {4, 16, 64, 256};
constexpr std::size_t groups = 8;
// Samples of a texel that a group spends on each number of them: as many runs as that takes, so
// that a rare sliver of an edge is met as often by many short runs as by a few long ones.
constexpr int samples_a_group = 512;
constexpr int size = 8;  // texels a side
constexpr std::size_t texels = size * size;

double height(double x, double y) {
  return 0.05 * (std::sin(2 * pi * x) + std::sin(2 * pi * y));
}

// Gentle Lambert hills: slopes to 24 degrees, lit from 30, so that no hill hides another or shades
// it. Normals are the formula's: with the facets' own, each texel would be a mosaic.
Mesostructure hills() {
  TriangleMesh mesh = test::height_field(64, height, [](double, double) { return 0; });
  for (const Vec3& p : mesh.positions) {
    mesh.normals.push_back(Vec3(-static_cast<float>(0.1 * pi * std::cos(2 * pi * p.x)),
                                -static_cast<float>(0.1 * pi * std::cos(2 * pi * p.y)), 1)
                               .normalized());
  }
  mesh.material_names = {"hills"};
  return test::structure(mesh, {Bsdf::lambert({0.8F, 0.6F, 0.4F})}, 0.1F);
}

// The same below a plate, whose rim and whose shadow's are edges.
Mesostructure covered_hills() {
  Mesostructure result = hills();
  TriangleMesh& mesh = result.mesh;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3& p : {Vec3(0.33F, 0.29F, 0.3F), Vec3(0.68F, 0.36F, 0.3F),
                        Vec3(0.61F, 0.71F, 0.3F), Vec3(0.26F, 0.64F, 0.3F)}) {
    mesh.positions.push_back(p);
    mesh.normals.emplace_back(0, 0, 1);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  mesh.materials.insert(mesh.materials.end(), {1, 1});
  mesh.material_names.emplace_back("plate");
  result.materials.push_back(Bsdf::lambert({0.3F, 0.9F, 0.3F}));
  result.reference_height = 0.3F;
  return result;
}

const Direction view = from_spherical(radians(20.0), 0.7);
const Direction light = from_spherical(radians(30.0), 2.1);

// [texel][group][place in `samples`] mean square error of green.
using Errors = std::vector<std::array<std::array<double, samples.size()>, groups>>;

Errors errors_of(const Mesostructure& structure, int max_bounces) {
  const auto traceable = std::make_shared<const TraceableStructure>(structure);
  // Without a table: what it errs in is rare and large, and not of the samples' making.
  const auto tracer_of = [&](int spp) {
    return ViewTracer(traceable, {light},
                      {.width = size,
                       .height = size,
                       .spp = spp,
                       .max_bounces = max_bounces,
                       .table = false,
                       .seed = 21});
  };
  // Its own square error is 1/32 of theirs at most.
  const std::vector<float> truth = tracer_of(32 * samples.back()).trace(view, 1'000'000).values;
  Errors errors(texels);
  std::uint64_t key = 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const ViewTracer tracer = tracer_of(samples[n]);
    const int runs_a_group = samples_a_group / samples[n];
    for (std::size_t g = 0; g < groups; ++g) {
      for (int run = 0; run < runs_a_group; ++run) {
        const std::vector<float> values = tracer.trace(view, key++).values;
        for (std::size_t t = 0; t < texels; ++t) {
          const double difference = static_cast<double>(values[3 * t + 1]) - truth[3 * t + 1];
          errors[t][g][n] += difference * difference / runs_a_group;
        }
      }
    }
  }
  return errors;
}

struct Rate {
  double slope = 0;  // of log RMSE over log samples, mean of the groups'
  double error = 0;
  // How often chance alone gives a slope so far above -1/2 (one-sided t over the groups).
  double slower = 1;
};

Rate rate_of(const Errors& errors, const std::vector<std::size_t>& region) {
  std::array<double, samples.size()> x{};
  for (std::size_t n = 0; n < samples.size(); ++n) x[n] = std::log(samples[n]);
  std::vector<double> slopes;
  for (std::size_t g = 0; g < groups; ++g) {
    std::array<double, samples.size()> y{};
    for (const std::size_t t : region)
      for (std::size_t n = 0; n < samples.size(); ++n) y[n] += errors[t][g][n];
    for (double& square : y) square = 0.5 * std::log(square);
    slopes.push_back(statistics::slope(x, y).slope);
  }
  Rate rate;
  for (const double s : slopes) rate.slope += s / groups;
  for (const double s : slopes) rate.error += (s - rate.slope) * (s - rate.slope);
  rate.error = std::sqrt(rate.error / (groups - 1) / groups);
  if (rate.slope > -0.5) rate.slower = statistics::t_test(slopes, -0.5) / 2;
  return rate;
}

// The texels across which the plate's rim or a shadow's boundary runs, told by a grid of rays, and
// the others.
struct Regions {
  std::vector<std::size_t> edges, smooth;
};

Regions regions_of(const Mesostructure& structure) {
  const TraceableStructure traceable(structure);
  constexpr float start = 0.5F;
  constexpr int fine = 64;
  Regions regions;
  for (std::size_t t = 0; t < texels; ++t) {
    int plate = 0;
    int dark = 0;
    for (int i = 0; i < fine * fine; ++i) {
      const auto place = [](std::size_t texel, int k) {
        return (static_cast<float>(texel) + (static_cast<float>(k) + 0.5F) / fine) / size;
      };
      const float back = (start - structure.reference_height) / view.z;
      const Vec3 origin(tile_fraction(place(t % size, i % fine) + view.x * back),
                        tile_fraction(1 - place(t / size, i / fine) + view.y * back), start);
      const RayHit hit = traceable.scene.intersect(origin, -view);
      const Facet& facet = traceable.facets[hit.primitive];
      const Vec3 point = ray_origin(facet.point(hit.u, hit.v), facet.normal);
      plate += facet.material;
      dark += traceable.scene.intersect(point, light).hit() ? 1 : 0;
    }
    const auto divided = [](int count) { return count > 0 && count < fine * fine; };
    (divided(plate) || divided(dark) ? regions.edges : regions.smooth).push_back(t);
  }
  return regions;
}

std::vector<std::size_t> all_texels() {
  std::vector<std::size_t> all(texels);
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

// False alarms of this family: 1 in 1000.
void expect_nowhere_slower(const Errors& errors) {
  for (std::size_t t = 0; t < texels; ++t) {
    const Rate rate = rate_of(errors, {t});
    INFO("texel " << t << ": slope " << rate.slope << " +- " << rate.error);
    CHECK(rate.slower > statistics::sidak(1e-3, texels));
  }
}

void expect_slope_below(double bound, const Errors& errors,
                        const std::vector<std::size_t>& region) {
  REQUIRE(region.size() > 8);
  const Rate rate = rate_of(errors, region);
  INFO("slope " << rate.slope << " +- " << rate.error);
  CHECK(rate.slope < bound);
  // Room enough that chance cannot decide: a t beyond 5 with 7 degrees of freedom, 1 in 1000.
  CHECK((bound - rate.slope) / rate.error > 5);
}

}  // namespace

// What to expect of scrambled nets: -3/2 where the integrand is smooth (Owen 1997), -3/4 where an
// edge runs through the two dimensions (He and Wang 2015). A bounce adds two dimensions of another
// net: what depends on one of the two alone falls as fast, the rest by -1/2.
TEST_CASE("on smooth parts the error falls far faster than one over the root of the samples") {
  const Errors errors = errors_of(hills(), 0);
  expect_slope_below(-1.4, errors, all_texels());
  expect_nowhere_slower(errors);
}

TEST_CASE("on smooth parts the error of a bounce falls faster than one over the root, too") {
  const Errors errors = errors_of(hills(), 1);
  expect_slope_below(-0.6, errors, all_texels());
  expect_nowhere_slower(errors);
}

TEST_CASE("at edges and shadows the error falls no slower than with random numbers") {
  const Regions regions = regions_of(covered_hills());
  const Errors errors = errors_of(covered_hills(), 0);
  expect_slope_below(-1.4, errors, regions.smooth);
  expect_slope_below(-0.65, errors, regions.edges);
  expect_nowhere_slower(errors);
}

TEST_CASE("at edges and shadows the error of a bounce falls no slower than with random numbers") {
  const Regions regions = regions_of(covered_hills());
  const Errors errors = errors_of(covered_hills(), 1);
  expect_slope_below(-0.6, errors, regions.smooth);
  expect_slope_below(-0.6, errors, regions.edges);
  expect_nowhere_slower(errors);
}

// A wave is 64 samples. Were the bounces of each the same, the error of what they bring would stay
// that of one wave. The ratio of two mean squares of 128 runs each is about 256 but for chance;
// below 100 less than once in a million times.
TEST_CASE("a texel by itself has new points in every wave", "[heavy]") {
  constexpr int runs = 128;
  const auto traceable = std::make_shared<const TraceableStructure>(hills());
  // What a bounce brings: direct light is of the same samples in both.
  const auto indirect = [&](int spp, std::uint64_t key) {
    const auto traced = [&](int max_bounces) -> double {
      return ViewTracer(traceable, {light},
                        {.width = 1,
                         .height = 1,
                         .spp = spp,
                         .max_bounces = max_bounces,
                         .table = false,
                         .seed = 5})
          .trace(view, key)
          .values[1];
    };
    return traced(1) - traced(0);
  };
  const double truth = indirect(1 << 20, 1'000'000);
  const auto square_error = [&](int spp) {
    double sum = 0;
    for (std::uint64_t run = 0; run < runs; ++run) {
      const double difference = indirect(spp, run) - truth;
      sum += difference * difference / runs;
    }
    return sum;
  };
  const double ratio = square_error(64) / square_error(16384);
  INFO("ratio " << ratio);
  CHECK(ratio > 100);
}
