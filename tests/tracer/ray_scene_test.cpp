// Rays one by one and in streams give the same answers.
#include "tracer/ray_scene.h"

#include <limits>

#include "btf/error.h"
#include "btf/random.h"

using namespace weft;

namespace {

TriangleMesh quad(float z) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.materials = {0, 0};
  mesh.material_names = {"default"};
  return mesh;
}

constexpr float infinity = std::numeric_limits<float>::infinity();

}  // namespace

TEST_CASE("the nearest of two sheets is hit") {
  const TriangleMesh low = quad(0);
  const TriangleMesh high = quad(1);
  const RayScene scene(std::array<const TriangleMesh*, 2>{&low, &high});
  const RayHit hit = scene.intersect({0.75F, 0.25F, 3}, {0, 0, -1}, 0, infinity);
  CHECK(hit.mesh == 1);
  CHECK(hit.primitive == 0);
  CHECK(hit.distance == Approx(2));
  CHECK_FALSE(scene.intersect({1.5F, 0.25F, 3}, {0, 0, -1}, 0, infinity).hit());
  CHECK(scene.occluded({0.5F, 0.2F, 0.5F}, {0, 0, 1}, 0, infinity));
  CHECK_FALSE(scene.occluded({0.5F, 0.2F, 0.5F}, {0, 0, 1}, 0, 0.25F));
}

TEST_CASE("streams agree with single rays") {
  const TriangleMesh low = quad(0);
  const TriangleMesh high = quad(1);
  const RayScene scene(std::array<const TriangleMesh*, 2>{&low, &high});
  constexpr std::size_t n = 1001;
  for (const Coherence coherence : {Coherence::coherent, Coherence::incoherent}) {
    RayStream nearest;
    RayStream shadow;
    nearest.resize(n);
    shadow.resize(n);
    std::vector<RayHit> expected;
    std::vector<bool> blocked;
    for (std::size_t i = 0; i < n; ++i) {
      const auto u = [&](int k) { return 4 * unit_float(hash_coordinates(i, k)) - 2; };
      const Vec3 origin(u(0), u(1), u(2));
      const Vec3 direction = Vec3(u(3), u(4), u(5)).normalized();
      nearest.set(i, origin, direction, 0, infinity);
      shadow.set(i, origin, direction, 0, infinity);
      expected.push_back(scene.intersect(origin, direction, 0, infinity));
      blocked.push_back(scene.occluded(origin, direction, 0, infinity));
    }
    scene.intersect(nearest, n, coherence);
    scene.occluded(shadow, n, coherence);
    for (std::size_t i = 0; i < n; ++i) {
      REQUIRE(nearest.mesh[i] == expected[i].mesh);
      if (expected[i].hit()) REQUIRE(nearest.tfar[i] == Approx(expected[i].distance));
      REQUIRE((shadow.tfar[i] < 0) == blocked[i]);
    }
  }
}

TEST_CASE("a position that is not finite is refused") {
  TriangleMesh mesh = quad(0);
  mesh.positions[2].z = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_WITH(RayScene(mesh), Catch::Contains("position 2"));
}
