#include "tracer/surface_hit.h"

#include <algorithm>
#include <cmath>

namespace weft {
namespace {

template <typename T>
T interpolate(const std::vector<T>& values, const std::array<std::uint32_t, 3>& triangle,
              const RayHit& hit) {
  return values[triangle[0]] * (1 - hit.u - hit.v) + values[triangle[1]] * hit.u +
         values[triangle[2]] * hit.v;
}

float largest_coordinate(const Vec3& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

/// Any unit vector perpendicular to `n`; for a tangent that is along the normal.
Vec3 perpendicular(const Vec3& n) {
  const Vec3 other = std::abs(n.x) < 0.5F ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  return (other - n * n.dot(other)).normalized();
}

}  // namespace

SurfaceHit surface_hit(const SceneShape& shape, const SceneMaterial& material, const RayHit& hit,
                       const Vec3& direction) {
  const TriangleMesh& mesh = shape.mesh;
  const auto& triangle = mesh.triangles[hit.primitive];
  const Vec3& p0 = mesh.positions[triangle[0]];
  const Vec3& p1 = mesh.positions[triangle[1]];
  const Vec3& p2 = mesh.positions[triangle[2]];

  SurfaceHit result;
  result.position = interpolate(mesh.positions, triangle, hit);
  result.normal = interpolate(mesh.normals, triangle, hit).normalized();
  const Vec3& n = result.normal;
  const Vec3 along = interpolate(mesh.tangents, triangle, hit);
  const Vec3 in_plane = along - n * n.dot(along);
  result.tangent = in_plane.length2() > 0 ? in_plane.normalized() : perpendicular(n);
  result.bitangent = n.cross(result.tangent);
  const Vec3 ng = (p1 - p0).cross(p2 - p0).normalized();
  result.geometric_normal = ng.dot(n) < 0 ? -ng : ng;
  // 64 units in the last place of the largest coordinate: above the rounding of the point's own
  // interpolation and of the intersection, at any scale and place of the scene.
  result.clearance =
      std::max({largest_coordinate(p0), largest_coordinate(p1), largest_coordinate(p2)}) *
      (64.0F / 16777216.0F);
  result.view = result.to_local(-direction);
  const Vec2 uv = interpolate(mesh.texcoords, triangle, hit);
  result.uv = {uv.x * material.repeat.x, uv.y * material.repeat.y};
  result.material = shape.material;
  return result;
}

TexelGradient::TexelGradient(const SceneShape& shape, const SceneMaterial& material,
                             const RayHit& hit) {
  const TriangleMesh& mesh = shape.mesh;
  const auto& triangle = mesh.triangles[hit.primitive];
  const Vec3 e1 = mesh.positions[triangle[1]] - mesh.positions[triangle[0]];
  const Vec3 e2 = mesh.positions[triangle[2]] - mesh.positions[triangle[0]];
  const Imath::V2i texels = material.appearance->texels();
  const Vec2 scale(material.repeat.x * texels.x, material.repeat.y * texels.y);
  const Vec2 d1 = (mesh.texcoords[triangle[1]] - mesh.texcoords[triangle[0]]) * scale;
  const Vec2 d2 = (mesh.texcoords[triangle[2]] - mesh.texcoords[triangle[0]]) * scale;
  // The dual basis of the edges: f1 . e1 = 1, f1 . e2 = 0, and the other way round.
  const Vec3 normal = e1.cross(e2);
  const float area2 = normal.length2();
  if (area2 == 0) return;
  const Vec3 f1 = e2.cross(normal) / area2;
  const Vec3 f2 = normal.cross(e1) / area2;
  u_gradient_ = f1 * d1.x + f2 * d2.x;
  v_gradient_ = f1 * d1.y + f2 * d2.y;
}

float TexelGradient::texels(const Vec3& step) const {
  return std::hypot(u_gradient_.dot(step), v_gradient_.dot(step));
}

float TexelGradient::texels(float width) const {
  return width * std::sqrt(u_gradient_.cross(v_gradient_).length());
}

float lod_of_width(float texels) {
  return texels > 1 ? std::log2(texels) : 0.0F;
}

}  // namespace weft
