// What a ray met: the point, its shading frame, its texture coordinates and the footprint there.
#pragma once

#include "btf/direction.h"
#include "tracer/ray_scene.h"
#include "tracer/scene.h"

namespace weft {

struct SurfaceHit {
  Vec3 position;
  Vec3 geometric_normal;  ///< unit, on the side of the shading normal
  float clearance = 0;    ///< how far along it a ray must start not to meet this triangle again
  // n = normalize(interpolated normals), t = normalize(T - n dot(n, T)), b = cross(n, t); never
  // flipped.
  Vec3 tangent;
  Vec3 bitangent;
  Vec3 normal;
  Direction view;  ///< in the local frame
  Texcoord uv;     ///< the material's repeat included
  std::size_t material = 0;
  float lod = 0;

  Direction to_local(const Vec3& world) const {
    return {world.dot(tangent), world.dot(bitangent), world.dot(normal)};
  }
  Vec3 to_world(const Direction& local) const {
    return tangent * local.x + bitangent * local.y + normal * local.z;
  }
  /// Where a ray that leaves on the geometric normal's side starts.
  Vec3 origin() const { return position + geometric_normal * clearance; }
};

/// The frame at a hit of `shape`, lod left at 0. `direction` is the ray's, unit.
SurfaceHit surface_hit(const SceneShape& shape, const SceneMaterial& material, const RayHit& hit,
                       const Vec3& direction);

/// How uv (repeat included) in texels change over the triangle of a hit.
class TexelGradient {
 public:
  TexelGradient(const SceneShape& shape, const SceneMaterial& material, const RayHit& hit);
  /// Texels that a step in the triangle's plane crosses.
  float texels(const Vec3& step) const;
  /// Texels along the side of a square of the triangle's plane with side `width`.
  float texels(float width) const;

 private:
  Vec3 u_gradient_;
  Vec3 v_gradient_;
};

/// log2 of a footprint's width in texels, at least 0.
float lod_of_width(float texels);

}  // namespace weft
