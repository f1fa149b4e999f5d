// The endless tile against a wide patch of real copies.
#include "acquisition/periodic_scene.h"

#include <cmath>

#include "btf/direction.h"
#include "btf/error.h"
#include "btf/random.h"
#include "tests/acquisition/known_structures.h"

using namespace weft;

namespace {

TriangleMesh tiled(const TriangleMesh& tile, int reach) {
  TriangleMesh patch;
  for (int j = -reach; j <= reach; ++j) {
    for (int i = -reach; i <= reach; ++i) {
      const auto first = static_cast<std::uint32_t>(patch.positions.size());
      for (const Vec3& p : tile.positions) {
        patch.positions.push_back(p + Vec3(static_cast<float>(i), static_cast<float>(j), 0));
      }
      for (const auto& t : tile.triangles)
        patch.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  }
  return patch;
}

}  // namespace

TEST_CASE("level rays meet what a wide patch of copies has in their way") {
  // Thin spikes far apart, one sticking out of the tile: rays pass many tiles before they meet one.
  TriangleMesh tile;
  tile.positions = {{0.9F, 0.45F, 0}, {1.3F, 0.55F, 0},  {1.1F, 0.5F, 1.0F},
                    {0.2F, 0.2F, 0},  {0.21F, 0.21F, 0}, {0.2F, 0.21F, 0.7F}};
  tile.triangles = {{0, 1, 2}, {3, 4, 5}};
  const PeriodicScene scene(tile);
  constexpr int reach = 40;
  const RayScene patch(tiled(tile, reach));
  constexpr std::size_t n = 4000;
  std::int64_t traced_on = 0;
  int compared = 0;
  int different = 0;
  for (std::size_t first = 0; first < n; first += lanes) {
    HitPacket rays{};
    RayPacket shadows{};
    for (std::size_t k = 0; k < lanes; ++k) {
      const auto u = [&](int dimension) {
        return unit_float(hash_coordinates(first + k, dimension, 9));
      };
      const Vec3 origin(u(0), u(1), u(2));
      const Direction d = from_spherical(radians(85.0 + 10 * u(3)), 6.28 * u(4));
      rays.ray.set(k, origin, d);
      shadows.set(k, origin, d);
    }
    const std::uint16_t active = 0x7FFF;  // the last one is left alone
    traced_on += scene.intersect(rays, active, Coherence::incoherent);
    scene.occluded(shadows, active, Coherence::incoherent);
    CHECK(rays.mesh[lanes - 1] == RayHit::none);
    for (std::size_t k = 0; k + 1 < lanes; ++k) {
      const Vec3 origin(rays.ray.ox[k], rays.ray.oy[k], rays.ray.oz[k]);
      const Direction d(rays.ray.dx[k], rays.ray.dy[k], rays.ray.dz[k]);
      const bool hit = rays.mesh[k] != RayHit::none;
      CHECK(hit == (shadows.tfar[k] < 0));
      CHECK(hit == scene.intersect(origin, d).hit());
      // The patch ends: only what is hit inside of it is known.
      const RayHit expected = patch.intersect(origin, d, 0, 1e9F);
      if (!expected.hit() || expected.distance > reach - 2) continue;
      ++compared;
      different += !hit || rays.primitive[k] != expected.primitive % tile.triangles.size() ||
                           std::abs(rays.u[k] - expected.u) > 1e-2F
                       ? 1
                       : 0;
    }
  }
  CHECK(traced_on > 100);
  CHECK(compared > 1000);
  CHECK(different <= 2);  // grazing the rim of a triangle, where rounding decides
}

TEST_CASE("a tile without triangles is refused, and one whose triangles have no area") {
  TriangleMesh line;
  line.positions = {{0, 0, 0}, {0.5F, 0, 0}, {1, 0, 0}};
  line.triangles = {{0, 1, 2}};
  CHECK_THROWS_WITH(PeriodicScene(line), Catch::Contains("no triangle with an area"));
  CHECK_THROWS_WITH(PeriodicScene(TriangleMesh{}), Catch::Contains("no triangles"));
}
