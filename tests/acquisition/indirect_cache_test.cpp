// The cache of indirect light against light that is traced.
#include "acquisition/indirect_cache.h"

#include <tbb/global_control.h>

#include <cmath>

#include "acquisition/view_tracer.h"
#include "btf/error.h"
#include "btf/hemisphere_sampling.h"
#include "tests/acquisition/known_structures.h"

using namespace weft;

namespace {

Mesostructure white_checker() {
  Mesostructure structure = test::checker(48);
  for (Bsdf& material : structure.materials) material = Bsdf::lambert(Rgb(0.9F, 0.6F, 0.3F));
  return structure;
}

TraceSettings settings_with(bool cache) {
  return {.width = 16,
          .height = 16,
          .spp = 64,
          .max_bounces = 4,
          .views = 81,
          .indirect_cache = cache,
          .seed = 3};
}

double mean(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

}  // namespace

TEST_CASE(
    "with the cache of indirect light, means are those of tracing to a fraction of a percent") {
  const std::vector<Direction> lights = named_directions("fibonacci:20");
  const ViewTracer cached(white_checker(), lights, settings_with(true));
  const ViewTracer traced(white_checker(), lights, settings_with(false));
  TraceSettings direct = settings_with(false);
  direct.max_bounces = 0;
  const ViewTracer without(white_checker(), lights, direct);
  CHECK(cached.indirect_cache().rays() > 0);
  CHECK(traced.indirect_cache().empty());
  for (const double theta : {0.1, 0.8, 1.3}) {
    const Direction view = from_spherical(theta, 2.0);
    const TracedView a = cached.trace(view, 1);
    const TracedView b = traced.trace(view, 2);
    INFO("theta " << theta);
    CHECK(a.statistics.bounce_rays == 0);
    CHECK(mean(a.values) == Approx(mean(b.values)).epsilon(0.004));
    // What is compared is not direct light alone.
    CHECK(mean(b.values) > 1.05 * mean(without.trace(view, 1).values));
  }
}

TEST_CASE("a cache of direct light alone is none") {
  TraceSettings settings = settings_with(true);
  settings.max_bounces = 0;
  const ViewTracer tracer(white_checker(), {{0, 0, 1}}, settings);
  CHECK(tracer.indirect_cache().empty());
}

TEST_CASE("the cache of indirect light is the same for any number of threads") {
  const auto values = [] {
    TraceSettings settings = settings_with(true);
    settings.spp = 8;
    const ViewTracer tracer(white_checker(), named_directions("fibonacci:20"), settings);
    return tracer.trace(from_spherical(0.5, 1.0), 0).values;
  };
  const std::vector<float> many = values();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  CHECK(values() == many);
}

TEST_CASE("the back of a facet is traced, cache or not") {
  // A sheet above a plane: seen from below by what is reflected, from above by the eye.
  TriangleMesh mesh = test::flat(Rgb(1)).mesh;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3& p : {Vec3(0.2F, 0.2F, 0.2F), Vec3(0.2F, 0.8F, 0.2F), Vec3(0.8F, 0.2F, 0.2F)})
    mesh.positions.push_back(p);
  mesh.triangles.push_back({first, first + 1, first + 2});  // clockwise: its back is on top
  mesh.materials.push_back(0);
  const Mesostructure structure = test::structure(mesh, {Bsdf::lambert(Rgb(0.8F))}, 0.2F);
  const std::vector<Direction> lights = named_directions("fibonacci:16");
  const Direction view = from_spherical(0.6, 1.0);
  const ViewTracer cached(structure, lights, settings_with(true));
  const ViewTracer traced(structure, lights, settings_with(false));
  const TracedView a = cached.trace(view, 1);
  CHECK(a.statistics.bounce_rays > 0);
  CHECK(mean(a.values) == Approx(mean(traced.trace(view, 2).values)).epsilon(0.006));
}

TEST_CASE("a cache of indirect light refuses what does not look the same from everywhere") {
  Mesostructure structure = test::checker(16);
  structure.materials.back() = Bsdf::conductor_f0(Rgb(0.9F), 0.2F);
  try {
    const ViewTracer tracer(structure, {{0, 0, 1}}, settings_with(true));
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.where() == "--indirect cache");
    CHECK(error.what() != nullptr);
  }
}
