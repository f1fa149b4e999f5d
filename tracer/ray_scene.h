// Rays against triangles and round fibres: the one interface to Embree (only ray_scene.cpp names
// it).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tracer/curves.h"
#include "tracer/lanes.h"
#include "tracer/triangle_mesh.h"

namespace weft {

/// Nearest hit of a ray. The hit point is (1-u-v) p0 + u p1 + v p2 of triangle `primitive` of mesh
/// `mesh`; curve sets count on after the meshes, and there it is `curve_point` of segment
/// `primitive`.
struct RayHit {
  static constexpr std::uint32_t none = 0xFFFFFFFF;
  float distance = 0;
  float u = 0;
  float v = 0;
  std::uint32_t mesh = none;  ///< `none` where nothing was hit
  std::uint32_t primitive = none;
  bool hit() const { return mesh != none; }
};

/// Many rays as a structure of arrays, for calls that trace them together. `resize` allocates;
/// reuse it.
struct RayStream {
  std::vector<float> ox, oy, oz, dx, dy, dz, tnear, tfar;
  // Written by `intersect`: distance is tfar.
  std::vector<float> u, v, ngx, ngy, ngz, time;
  std::vector<std::uint32_t> primitive, mesh, instance, mask, id, flags;
  void resize(std::size_t n);
  std::size_t size() const { return ox.size(); }
  void set(std::size_t i, const Vec3& origin, const Vec3& direction, float near, float far) {
    ox[i] = origin.x;
    oy[i] = origin.y;
    oz[i] = origin.z;
    dx[i] = direction.x;
    dy[i] = direction.y;
    dz[i] = direction.z;
    tnear[i] = near;
    tfar[i] = far;
  }
};

/// Sixteen rays that are traced together.
struct RayPacket {
  FloatLanes ox, oy, oz, tnear, dx, dy, dz, time, tfar;
  WordLanes mask, id, flags;

  /// From the origin on without end.
  void set(std::size_t i, const Vec3& origin, const Vec3& direction) {
    ox[i] = origin.x;
    oy[i] = origin.y;
    oz[i] = origin.z;
    dx[i] = direction.x;
    dy[i] = direction.y;
    dz[i] = direction.z;
  }
};

/// And what they hit; `mesh` is RayHit::none for a miss, the distance is ray.tfar.
struct HitPacket {
  RayPacket ray;
  FloatLanes ngx, ngy, ngz, u, v;
  WordLanes primitive, mesh, instance;
};

/// Whether the rays of a stream, in order, run side by side (primary and shadow rays to one light)
/// or not.
enum class Coherence { coherent, incoherent };

class RayScene {
 public:
  /// Builds the acceleration structure over copies of the meshes' triangles and of the curves;
  /// deterministic.
  /// @throws Error  where a position is not finite.
  explicit RayScene(std::span<const TriangleMesh* const> meshes,
                    std::span<const CurveSet* const> curves = {});
  explicit RayScene(const TriangleMesh& mesh);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  RayHit intersect(const Vec3& origin, const Vec3& direction, float near, float far) const;
  bool occluded(const Vec3& origin, const Vec3& direction, float near, float far) const;

  /// The first `count` rays. Rays with tnear > tfar are left alone. A miss has mesh[i] ==
  /// RayHit::none.
  void intersect(RayStream& rays, std::size_t count, Coherence coherence) const;
  /// An occluded ray has tfar[i] < 0 afterwards.
  void occluded(RayStream& rays, std::size_t count, Coherence coherence) const;

  /// Those rays of a packet whose bit of `active` is set, from tnear = 0 to tfar. The others are
  /// left alone.
  void intersect(HitPacket& packet, std::uint16_t active, Coherence coherence) const;
  void occluded(RayPacket& packet, std::uint16_t active, Coherence coherence) const;

 private:
  struct Device;
  // Embree tells a hit on a curve by its normal: writes `v` instead.
  float around_curve(const RayHit& hit, const Vec3& normal) const;
  template <typename Rays>
  void name_curve_hits(Rays& rays, std::size_t count) const;

  std::unique_ptr<Device> device_;
  std::uint32_t first_curves_ = RayHit::none;  // the number of the first curve set
};

}  // namespace weft
