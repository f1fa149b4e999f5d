// A tile's triangles as a path needs them: a cache line each.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "acquisition/periodic_scene.h"
#include "tracer/triangle_mesh.h"

namespace weft {

struct alignas(64) Facet {
  Vec3 corner;  ///< tile units
  Vec3 edge_u;  ///< from the corner
  Vec3 edge_v;
  Vec3 normal;  ///< unit, on the counter-clockwise side; zero for a triangle without an area
  std::uint16_t material;

  bool degenerate() const { return normal == Vec3(0, 0, 0); }
  Vec3 point(float u, float v) const { return corner + edge_u * u + edge_v * v; }
};

std::vector<Facet> facets_of(const TriangleMesh& mesh);

/// The unit normal to shade with at (u, v) of a triangle that a ray of `direction` hits: the mesh's
/// own, on the side of `facet_normal` (the one towards the viewer, `behind` where
/// that is not the counter-clockwise one); the facet's where the mesh has
/// none, or where its own faces away from the viewer and so has nothing to say.
Vec3 shading_normal(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v,
                    const Vec3& facet_normal, bool behind, const Vec3& direction);

/// Where a ray that leaves `point` on the side of `normal` begins: off the surface by about 40
/// roundings, and within the tile.
inline Vec3 ray_origin(const Vec3& point, const Vec3& normal) {
  constexpr float offset = 3e-6F;
  const float largest = std::max({1.0F, std::abs(point.x), std::abs(point.y), std::abs(point.z)});
  const Vec3 p(tile_fraction(point.x), tile_fraction(point.y), point.z);
  const Vec3 origin = p + normal * (offset * largest);
  return {tile_fraction(origin.x), tile_fraction(origin.y), origin.z};
}

}  // namespace weft
