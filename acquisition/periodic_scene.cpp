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
constexpr int max_tiles_wide = 8;
// A ray that goes on begins this much before where it left, so that no surface falls between.
constexpr float step_back = 1e-5F;
// A ray still travelling after this many tiles runs level between the structure's heights for good.
constexpr int max_moves = 1'000'000;

bool has_area(const TriangleMesh& mesh) {
  return std::ranges::any_of(mesh.triangles, [&](const auto& t) {
    const Vec3& a = mesh.positions[t[0]];
    return ((mesh.positions[t[1]] - a) % (mesh.positions[t[2]] - a)).length2() > 0;
  });
}

struct Bounds {
  Vec3 low{infinity, infinity, infinity};
  Vec3 high{-infinity, -infinity, -infinity};
};

Bounds bounds_of(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw bad_input("mesostructure", "has no triangles");
  if (!has_area(mesh)) throw bad_input("mesostructure", "has no triangle with an area");
  Bounds bounds;
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
int reach_of(const TriangleMesh& mesh, const Bounds& bounds) {
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
  return (copies * copies * mesh.triangles.size() <= triangles_for_wide_reach ? 2 : 1) + around;
}

TriangleMesh copy_at(const TriangleMesh& mesh, int column, int row) {
  TriangleMesh copy;
  copy.triangles = mesh.triangles;
  copy.positions.reserve(mesh.positions.size());
  const Vec3 shift(static_cast<float>(column), static_cast<float>(row), 0);
  for (const Vec3& p : mesh.positions) copy.positions.push_back(p + shift);
  return copy;
}

RayScene scene_of(const TriangleMesh& mesh, int reach) {
  std::vector<TriangleMesh> copies;
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column)
      copies.push_back(copy_at(mesh, column, row));
  }
  std::vector<const TriangleMesh*> pointers;
  for (const TriangleMesh& copy : copies) pointers.push_back(&copy);
  return RayScene(pointers);
}

Vec3 origin_of(const RayStream& rays, std::size_t i) {
  return {rays.ox[i], rays.oy[i], rays.oz[i]};
}
Vec3 direction_of(const RayStream& rays, std::size_t i) {
  return {rays.dx[i], rays.dy[i], rays.dz[i]};
}

}  // namespace

PeriodicScene::PeriodicScene(const TriangleMesh& tile)
    : scene_(scene_of(tile, reach_of(tile, bounds_of(tile)))) {
  const Bounds bounds = bounds_of(tile);
  const auto reach = static_cast<float>(reach_of(tile, bounds));
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

void PeriodicScene::bound(RayStream& rays, std::size_t count) const {
  for (std::size_t i = 0; i < count; ++i) {
    rays.tfar[i] = exit(origin_of(rays, i), direction_of(rays, i)).distance;
  }
}

// Follows ray i, which left the copies without a hit, tile by tile. Its hit is written into the
// stream.
std::int64_t PeriodicScene::trace_on(RayStream& rays, std::size_t i) const {
  const Vec3 direction = direction_of(rays, i);
  Vec3 origin = origin_of(rays, i);
  Exit end = exit(origin, direction);
  std::int64_t traced = 0;
  while (end.sideways && traced < max_moves) {
    origin += direction * std::max(0.0F, end.distance - step_back);
    origin.x = tile_fraction(origin.x);
    origin.y = tile_fraction(origin.y);
    end = exit(origin, direction);
    ++traced;
    const RayHit hit = scene_.intersect(origin, direction, 0, end.distance);
    if (hit.hit()) {
      rays.mesh[i] = hit.mesh;
      rays.primitive[i] = hit.primitive;
      rays.u[i] = hit.u;
      rays.v[i] = hit.v;
      rays.tfar[i] = -infinity;
      break;
    }
  }
  return traced;
}

std::int64_t PeriodicScene::intersect(RayStream& rays, std::size_t count,
                                      Coherence coherence) const {
  bound(rays, count);
  scene_.intersect(rays, count, coherence);
  std::int64_t traced_on = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (rays.mesh[i] == RayHit::none) traced_on += trace_on(rays, i);
  }
  return traced_on;
}

std::int64_t PeriodicScene::occluded(RayStream& rays, std::size_t count,
                                     Coherence coherence) const {
  bound(rays, count);
  scene_.occluded(rays, count, coherence);
  std::int64_t traced_on = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (rays.tfar[i] >= 0) traced_on += trace_on(rays, i);
  }
  return traced_on;
}

}  // namespace weft
