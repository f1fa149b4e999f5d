// A tile's triangles and curves repeated without end in x and y, for rays.
//
// A few copies around the central tile are real and serve nearly all rays; a ray that leaves them
// below the top is moved back by whole tiles and goes on, so that the answer is that of the endless
// structure.
#pragma once

#include <cmath>
#include <cstdint>

#include "tracer/ray_scene.h"
#include "tracer/triangle_mesh.h"

namespace weft {

/// The place of a coordinate within its tile, in [0, 1).
inline float tile_fraction(float x) {
  const float f = x - std::floor(x);
  return f < 1 ? f : 0;
}

class PeriodicScene {
 public:
  /// @param tile    in tile units: repeats with period 1 in x and y; may stick out of [0, 1]^2.
  /// @param curves  the same; part of the tile.
  /// @throws Error  where it has neither triangles nor curves, a position is not finite, or it
  /// sticks out by more than 8 tiles.
  explicit PeriodicScene(const TriangleMesh& tile, const CurveSet& curves = {});

  float bottom() const { return bottom_; }
  float top() const { return top_; }

  /// Nearest hits of the rays whose bit of `active` is set. Their origins have x, y in [0, 1];
  /// tnear and tfar are set here. `primitive`, `u`, `v` name the hit on the tile's own triangle, or
  /// on its curves, whose segments count on after the triangles; mesh is RayHit::none for a miss.
  /// @returns how many single rays were traced on after leaving the copies.
  std::int64_t intersect(HitPacket& packet, std::uint16_t active, Coherence coherence) const;

  /// The same for occlusion: tfar < 0 afterwards where something is in the way.
  std::int64_t occluded(RayPacket& packet, std::uint16_t active, Coherence coherence) const;

  /// Sets tfar to where each ray leaves the copies. Returns the rays that leave them sideways.
  std::uint16_t bound(RayPacket& packet) const;
  /// The copies, for rays that `bound` has ended.
  const RayScene& copies() const { return scene_; }

  /// The same for one ray. `distance` is not that to the hit where it was traced on.
  RayHit intersect(const Vec3& origin, const Vec3& direction) const;

 private:
  struct Exit {
    float distance;
    bool sideways;
  };
  struct TracedOn {
    RayHit hit;
    std::int64_t rays = 0;
  };
  Exit exit(const Vec3& origin, const Vec3& direction) const;
  TracedOn trace_on(Vec3 origin, const Vec3& direction) const;
  // The copies' nearest hit of one ray, under the tile's numbers.
  RayHit nearest(const Vec3& origin, const Vec3& direction, float far) const;

  float bottom_;
  float top_;
  float margin_;  // above the top and below the bottom
  Vec2 low_;      // the copies are complete between these two corners
  Vec2 high_;
  std::uint32_t first_curves_ = RayHit::none;  // number of the copies' first curve set in the scene
  std::uint32_t triangles_;
  RayScene scene_;
};

}  // namespace weft
