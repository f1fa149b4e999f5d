#include "acquisition/periodic_scene.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "btf/error.h"

namespace weft {

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
// More copies serve more rays in packets; fewer keep large meshes in memory.
constexpr std::size_t triangles_for_wide_reach = 1'000'000;
constexpr std::size_t triangles_a_segment = 4;  // of a curve, by memory
constexpr int max_tiles_wide = 8;
// A ray that goes on begins this much before where it left, so that no surface falls between.
constexpr float step_back = 1e-5F;
// A ray still travelling after this many tiles runs level between the structure's heights for good.
constexpr int max_moves = 1'000'000;

Bounds bounds_of(const TriangleMesh& mesh, const CurveSet& curves) {
  if (mesh.triangles.empty() && curves.segments.empty())
    throw bad_input("mesostructure", "has no triangles");
  if (curves.segments.empty() && !has_area(mesh))
    throw bad_input("mesostructure", "has no triangle with an area");
  Bounds bounds = bounds_of(curves);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      const Vec3& p = mesh.positions[corner];
      for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(p[axis])) {
          throw bad_input("mesostructure", fmt::format("vertex {} is not finite", corner));
        }
        bounds.low[axis] = std::min(bounds.low[axis], p[axis]);
        bounds.high[axis] = std::max(bounds.high[axis], p[axis]);
      }
    }
  }
  return bounds;
}

// Copies to each side: what is complete reaches a whole tile further than the central one, two
// where that is cheap.
int reach_of(const TriangleMesh& mesh, const CurveSet& curves, const Bounds& bounds) {
  const float overhang =
      std::max({0.0F, bounds.high.x - 1, bounds.high.y - 1, -bounds.low.x, -bounds.low.y});
  if (overhang > max_tiles_wide) {
    throw bad_input("mesostructure",
                    fmt::format("sticks out {} tiles to a side; at most {} are possible", overhang,
                                max_tiles_wide),
                    "scale it into [0, 1]");
  }
  const int around = static_cast<int>(std::ceil(overhang));
  const auto copies = static_cast<std::size_t>(2 * (2 + around) + 1);
  const std::size_t size = mesh.triangles.size() + triangles_a_segment * curves.segments.size();
  return (copies * copies * size <= triangles_for_wide_reach ? 2 : 1) + around;
}

TriangleMesh copy_at(const TriangleMesh& mesh, int column, int row) {
  TriangleMesh copy;
  copy.triangles = mesh.triangles;
  copy.positions.reserve(mesh.positions.size());
  const Vec3 shift(static_cast<float>(column), static_cast<float>(row), 0);
  for (const Vec3& p : mesh.positions) copy.positions.push_back(p + shift);
  return copy;
}

CurveSet copy_at(const CurveSet& curves, int column, int row) {
  CurveSet copy;
  copy.segments = curves.segments;
  copy.controls = curves.controls;
  const Vec3 shift(static_cast<float>(column), static_cast<float>(row), 0);
  for (CurveSet::Control& control : copy.controls) control.position += shift;
  return copy;
}

template <typename Shape>
std::vector<Shape> copies_of(const Shape& shape, int reach) {
  std::vector<Shape> copies;
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column)
      copies.push_back(copy_at(shape, column, row));
  }
  return copies;
}

template <typename Shape>
std::vector<const Shape*> pointers_to(const std::vector<Shape>& shapes) {
  std::vector<const Shape*> pointers;
  for (const Shape& shape : shapes) pointers.push_back(&shape);
  return pointers;
}

RayScene scene_of(const TriangleMesh& mesh, const CurveSet& curves, int reach) {
  std::vector<TriangleMesh> meshes;
  if (!mesh.triangles.empty()) meshes = copies_of(mesh, reach);
  std::vector<CurveSet> sets;
  if (!curves.segments.empty()) sets = copies_of(curves, reach);
  return RayScene(pointers_to(meshes), pointers_to(sets));
}

}  // namespace

PeriodicScene::PeriodicScene(const TriangleMesh& tile, const CurveSet& curves)
    : triangles_(static_cast<std::uint32_t>(tile.triangles.size())),
      scene_(scene_of(tile, curves, reach_of(tile, curves, bounds_of(tile, curves)))) {
  const Bounds bounds = bounds_of(tile, curves);
  const int copies = reach_of(tile, curves, bounds);
  const auto meshes = static_cast<std::uint32_t>((2 * copies + 1) * (2 * copies + 1));
  if (!curves.segments.empty()) first_curves_ = triangles_ > 0 ? meshes : 0;
  const auto reach = static_cast<float>(copies);
  bottom_ = bounds.low.z;
  top_ = bounds.high.z;
  margin_ = 1e-4F * std::max({1.0F, std::abs(top_), std::abs(bottom_)});
  low_ = Vec2(bounds.high.x - 1, bounds.high.y - 1) - Vec2(reach, reach);
  high_ = Vec2(bounds.low.x + 1, bounds.low.y + 1) + Vec2(reach, reach);
}

// Where a ray leaves the box of complete copies; sideways only where that comes before the top or
// the bottom.
PeriodicScene::Exit PeriodicScene::exit(const Vec3& origin, const Vec3& direction) const {
  float side = infinity;
  for (int axis = 0; axis < 2; ++axis) {
    if (direction[axis] > 0) side = std::min(side, (high_[axis] - origin[axis]) / direction[axis]);
    if (direction[axis] < 0) side = std::min(side, (low_[axis] - origin[axis]) / direction[axis]);
  }
  float level = infinity;
  if (direction.z > 0) level = (top_ + margin_ - origin.z) / direction.z;
  if (direction.z < 0) level = (bottom_ - margin_ - origin.z) / direction.z;
  if (side < level) return {std::max(side, 0.0F), true};
  return {std::max(level, 0.0F), false};
}

// The same for sixteen, into tfar. Returns the rays that leave sideways.
std::uint16_t PeriodicScene::bound(RayPacket& packet) const {
  const auto reach = [](const FloatLanes& origin, const FloatLanes& direction, float low,
                        float high) {
    const FloatLanes edge = select(direction > 0, all_lanes(high), all_lanes(low));
    return select(direction == 0, all_lanes(infinity), (edge - origin) / direction);
  };
  const FloatLanes side = smaller(reach(packet.ox, packet.dx, low_.x, high_.x),
                                  reach(packet.oy, packet.dy, low_.y, high_.y));
  const FloatLanes level = reach(packet.oz, packet.dz, bottom_ - margin_, top_ + margin_);
  packet.tfar = larger(smaller(side, level), 0.0F);
  return bits_of_lanes(side < level);
}

RayHit PeriodicScene::nearest(const Vec3& origin, const Vec3& direction, float far) const {
  RayHit hit = scene_.intersect(origin, direction, 0, far);
  if (hit.hit() && hit.mesh >= first_curves_) hit.primitive += triangles_;
  return hit;
}

// Follows a ray that left the copies without a hit, tile by tile.
PeriodicScene::TracedOn PeriodicScene::trace_on(Vec3 origin, const Vec3& direction) const {
  Exit end = exit(origin, direction);
  TracedOn result;
  while (end.sideways && result.rays < max_moves && !result.hit.hit()) {
    origin += direction * std::max(0.0F, end.distance - step_back);
    origin.x = tile_fraction(origin.x);
    origin.y = tile_fraction(origin.y);
    end = exit(origin, direction);
    ++result.rays;
    result.hit = nearest(origin, direction, end.distance);
  }
  return result;
}

namespace {

Vec3 origin_of(const RayPacket& packet, int i) {
  return {packet.ox[i], packet.oy[i], packet.oz[i]};
}
Vec3 direction_of(const RayPacket& packet, int i) {
  return {packet.dx[i], packet.dy[i], packet.dz[i]};
}

}  // namespace

std::int64_t PeriodicScene::intersect(HitPacket& packet, std::uint16_t active,
                                      Coherence coherence) const {
  const std::uint16_t sideways = bound(packet.ray) & active;
  scene_.intersect(packet, active, coherence);
  if (first_curves_ != RayHit::none) {
    for (int i = 0; i < lanes; ++i) {
      if (packet.mesh[i] != RayHit::none && packet.mesh[i] >= first_curves_)
        packet.primitive[i] += triangles_;
    }
  }
  if (sideways == 0) return 0;
  std::int64_t traced_on = 0;
  for (int i = 0; i < lanes; ++i) {
    if ((sideways >> i & 1U) == 0 || packet.mesh[i] != RayHit::none) continue;
    const TracedOn on = trace_on(origin_of(packet.ray, i), direction_of(packet.ray, i));
    packet.mesh[i] = on.hit.mesh;
    packet.primitive[i] = on.hit.primitive;
    packet.u[i] = on.hit.u;
    packet.v[i] = on.hit.v;
    traced_on += on.rays;
  }
  return traced_on;
}

std::int64_t PeriodicScene::occluded(RayPacket& packet, std::uint16_t active,
                                     Coherence coherence) const {
  const std::uint16_t sideways = bound(packet) & active;
  scene_.occluded(packet, active, coherence);
  if (sideways == 0) return 0;
  std::int64_t traced_on = 0;
  for (int i = 0; i < lanes; ++i) {
    if ((sideways >> i & 1U) == 0 || packet.tfar[i] < 0) continue;
    const TracedOn on = trace_on(origin_of(packet, i), direction_of(packet, i));
    if (on.hit.hit()) packet.tfar[i] = -infinity;
    traced_on += on.rays;
  }
  return traced_on;
}

RayHit PeriodicScene::intersect(const Vec3& origin, const Vec3& direction) const {
  const RayHit hit = nearest(origin, direction, exit(origin, direction).distance);
  return hit.hit() ? hit : trace_on(origin, direction).hit;
}

}  // namespace weft
