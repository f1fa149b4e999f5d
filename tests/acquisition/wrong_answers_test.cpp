// Where the visibility table is wrong: how often it is for rays to the open, and that what is
// traced all the same makes it good.
#include <cmath>

#include "acquisition/view_tracer.h"
#include "btf/hemisphere_sampling.h"
#include "btf/random.h"
#include "tests/acquisition/known_structures.h"
#include "tests/statistics.h"

using namespace weft;

namespace {

// Wires of 0.0004 tiles that stand on a plane: their shadows slip between the points that a cell
// asks.
Mesostructure wires() {
  TriangleMesh mesh = test::flat(Rgb(1)).mesh;
  const auto add_wall = [&](const Vec3& foot, const Vec3& along) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const float z : {0.0F, 0.4F}) {
      mesh.positions.push_back(foot + Vec3(0, 0, z));
      mesh.positions.push_back(foot + along + Vec3(0, 0, z));
    }
    mesh.triangles.push_back({first, first + 1, first + 3});
    mesh.triangles.push_back({first, first + 3, first + 2});
    mesh.materials.insert(mesh.materials.end(), {0, 0});
  };
  for (int i = 0; i < 1000; ++i) {
    const Vec3 foot(unit_float(hash_coordinates(i, 0)), unit_float(hash_coordinates(i, 1)), 0);
    add_wall(foot, {0.0004F, 0, 0});
    add_wall(foot, {0, 0.0004F, 0});
  }
  return test::structure(mesh, {Bsdf::lambert(Rgb(0.5F))}, 0.4F);
}

// Four white squares of 0.1 tiles, 0.3 above a white plane.
Mesostructure roofs() {
  TriangleMesh mesh = test::flat(Rgb(1)).mesh;
  for (const auto& [x, y] : {std::pair{0.2F, 0.2F}, {0.7F, 0.2F}, {0.2F, 0.7F}, {0.7F, 0.7F}}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const auto& [u, v] : {std::pair{0.0F, 0.0F}, {0.1F, 0.0F}, {0.1F, 0.1F}, {0.0F, 0.1F}})
      mesh.positions.emplace_back(x + u, y + v, 0.3F);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
    mesh.materials.insert(mesh.materials.end(), {0, 0});
  }
  return test::structure(mesh, {Bsdf::lambert(Rgb(1))}, 0.3F);
}

// Sixteen lights all around.
std::vector<Direction> ring_at_30_degrees() {
  std::vector<Direction> lights;
  for (int i = 0; i < 16; ++i) lights.push_back(from_spherical(radians(30.0), radians(22.5 * i)));
  return lights;
}

// Of the sum of all values, traced with the table over that without; a mean of 16 runs.
struct Mean {
  std::vector<double> differences;  // of each run, relative
  double mean = 0;
  double standard_error = 0;
  TraceStatistics statistics;  // with the table
};

Mean compare_means(const Mesostructure& structure, const std::vector<Direction>& lights,
                   const TraceSettings& settings, const Direction& view) {
  constexpr int runs = 16;
  TraceSettings plain = settings;
  plain.spp /= 2;
  plain.table = false;
  const ViewTracer with(structure, lights, settings);
  const ViewTracer without(structure, lights, plain);
  REQUIRE(with.visibility().rays() > 0);
  const auto sum = [](const TracedView& traced) {
    double total = 0;
    for (const float value : traced.values) total += value;
    return total / static_cast<double>(traced.values.size());
  };
  Mean result;
  for (std::uint64_t run = 0; run < runs; ++run) {
    const TracedView a = with.trace(view, run);
    const double b = sum(without.trace(view, 100 + run));
    result.differences.push_back(sum(a) / b - 1);
    result.mean += result.differences.back() / runs;
    result.statistics += a.statistics;
  }
  double variance = 0;
  for (const double d : result.differences)
    variance += (d - result.mean) * (d - result.mean) / (runs - 1) / runs;
  result.standard_error = std::sqrt(variance);
  return result;
}

}  // namespace

TEST_CASE("where the table is often wrong, the mean is right all the same", "[slow]") {
  // A thousand views: ten rays a cell and light, and its cells are not cut finer.
  const Mean result = compare_means(
      wires(), named_directions("fibonacci:36"),
      {.width = 16, .height = 16, .spp = 256, .max_bounces = 0, .views = 1000, .seed = 2},
      {0, 0, 1});
  const double rate = static_cast<double>(result.statistics.wrong_answers) /
                      static_cast<double>(result.statistics.answers_checked);
  INFO(rate << " wrong; the mean is off by " << result.mean << " +- " << result.standard_error);
  CHECK(rate > 1e-3);
  // Uncorrected, the mean would be off by about the rate.
  CHECK(result.standard_error < rate / 5);
  CHECK(statistics::t_test(result.differences, 0) > 1e-3);
}

TEST_CASE("where rays to the open meet roofs between all lights, the mean is right all the same") {
  // The lights are seen from all of the ground, and from beneath small roofs hide what is between
  // them.
  const std::vector<Direction> lights = ring_at_30_degrees();
  const TraceSettings settings{
      .width = 16, .height = 16, .spp = 1024, .max_bounces = 3, .views = 1000, .seed = 5};
  const Mean result = compare_means(roofs(), lights, settings, from_spherical(0.9, 0.3));
  const auto open = static_cast<double>(result.statistics.open_bounces);
  const double share = open / static_cast<double>(result.statistics.paths);
  const double wrong = static_cast<double>(result.statistics.open_wrong) /
                       static_cast<double>(result.statistics.open_checked);
  INFO(share << " a path are open, " << wrong << " of them wrong; the mean is off by "
             << result.mean << " +- " << result.standard_error);
  CHECK(wrong > 5e-3);
  CHECK(share > 0.08);
  // Uncorrected, the mean would be off by 0.16 %.
  CHECK(result.standard_error < 3e-4);
  CHECK(statistics::t_test(result.differences, 0) > 1e-3);
}

TEST_CASE("rays to the open are traced more often where some meet something after all") {
  const auto every = [](const Mesostructure& structure, const std::vector<Direction>& lights) {
    const TraceSettings settings{.width = 32, .height = 32, .spp = 16, .views = 81};
    return ViewTracer(structure, lights, settings).visibility().open_check_every();
  };
  CHECK(every(test::checker(64), named_directions("ubo81")) == 16);
  CHECK(every(test::rings(128, 16), named_directions("ubo81")) == 16);
  CHECK(every(roofs(), ring_at_30_degrees()) == 4);
  // Too few lights to say which rays are open, and so nothing to count.
  CHECK(every(test::checker(64), {{0, 0, 1}}) == 4);
}

TEST_CASE("rays that the table takes to be open hardly ever meet anything") {
  const auto rate_of = [](const Mesostructure& structure) {
    const TraceSettings settings{
        .width = 32, .height = 32, .spp = 64, .max_bounces = 2, .views = 100'000, .seed = 1};
    const ViewTracer tracer(structure, named_directions("fibonacci:36"), settings);
    const TraceStatistics s = tracer.trace(from_spherical(0.8, 2.0), 3).statistics;
    const auto asked = static_cast<double>(s.bounce_rays + s.open_bounces - s.open_checked);
    INFO(s.open_bounces << " of " << asked << " open, " << s.open_checked << " traced, "
                        << s.open_wrong << " of them met something");
    CHECK(static_cast<double>(s.open_bounces) > 0.25 * asked);
    const double every = tracer.visibility().open_check_every();
    CHECK(static_cast<double>(s.open_checked) > 0.9 / every * static_cast<double>(s.open_bounces));
    CHECK(static_cast<double>(s.open_checked) < 1.1 / every * static_cast<double>(s.open_bounces));
    CHECK(static_cast<double>(s.open_wrong) < 5e-3 * static_cast<double>(s.open_checked));
  };
  rate_of(test::checker(64));
  rate_of(test::rings(128, 16));
}
