#include "tests/stability/direct_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tracer/ray_scene.h"

namespace weft::test {

std::vector<double> direct_light(const Mesostructure& structure, const std::vector<double>& albedo,
                                 const Direction& view, const Direction& light, int size,
                                 int fine) {
  const TriangleMesh& tile = structure.mesh;
  const auto [lowest, highest] = std::ranges::minmax_element(tile.positions, {}, &Vec3::z);
  const float low = lowest->z - 0.01F;
  const float high = highest->z + 0.01F;
  // Where the rays' boxes end, sideways.
  const auto travel = [&](const Direction& d, int axis, float from, float to) {
    return d[axis] / d.z * (to - from);
  };
  std::array<int, 2> first{};
  std::array<int, 2> last{};
  for (int axis = 0; axis < 2; ++axis) {
    const float up = travel(view, axis, structure.reference_height, high);
    const float down = travel(view, axis, structure.reference_height, low);
    const float on = travel(light, axis, low, high);
    first[axis] = static_cast<int>(std::floor(std::min(up, down) + std::min(0.0F, on))) - 1;
    last[axis] = static_cast<int>(std::ceil(std::max(up, down) + std::max(0.0F, on))) + 1;
  }
  TriangleMesh patch;
  for (int j = first[1]; j <= last[1]; ++j) {
    for (int i = first[0]; i <= last[0]; ++i) {
      const auto begin = static_cast<std::uint32_t>(patch.positions.size());
      const Vec3 shift(static_cast<float>(i), static_cast<float>(j), 0);
      for (const Vec3& p : tile.positions) patch.positions.push_back(p + shift);
      for (const auto& t : tile.triangles)
        patch.triangles.push_back({t[0] + begin, t[1] + begin, t[2] + begin});
    }
  }
  const RayScene scene(patch);
  std::vector<double> values(static_cast<std::size_t>(size) * size);
  const int points = size * fine;
  for (int y = 0; y < points; ++y) {
    for (int x = 0; x < points; ++x) {
      const Vec3 plane((static_cast<float>(x) + 0.5F) / static_cast<float>(points),
                       1 - (static_cast<float>(y) + 0.5F) / static_cast<float>(points),
                       structure.reference_height);
      const Vec3 eye = plane + view * ((high - plane.z) / view.z);
      const RayHit hit = scene.intersect(eye, -view, 0, 1e9F);
      if (!hit.hit()) continue;
      const auto& [a, b, c] = patch.triangles[hit.primitive];
      Vec3 normal =
          ((patch.positions[b] - patch.positions[a]) % (patch.positions[c] - patch.positions[a]))
              .normalized();
      if ((normal ^ view) < 0) normal = -normal;
      const float cosine = normal ^ light;
      if (cosine <= 0 || scene.occluded(eye - view * hit.distance + normal * 1e-5F, light, 0, 1e9F))
        continue;
      const std::size_t texel = static_cast<std::size_t>(y / fine) * size + x / fine;
      values[texel] += albedo[tile.materials[hit.primitive % tile.triangles.size()]] * cosine /
                       std::numbers::pi / (fine * fine);
    }
  }
  return values;
}

}  // namespace weft::test
