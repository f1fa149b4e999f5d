// Limit surfaces against what is known in closed form.
#include "tracer/subdivision.h"

#include <catch2/catch.hpp>

using namespace weft;

namespace {

PolygonMesh grid(int n, float (*height)(float, float)) {
  PolygonMesh mesh;
  mesh.material_names = {"left", "right"};
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      const auto fx = static_cast<float>(x);
      const auto fy = static_cast<float>(y);
      mesh.positions.emplace_back(fx, fy, height(fx, fy));
    }
  }
  const auto index = [n](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        mesh.corners.push_back(index(x + dx, y + dy));
      }
      mesh.face_sizes.push_back(4);
      mesh.materials.push_back(x < n / 2 ? 0 : 1);
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("a regular cage becomes its bicubic B-spline") {
  // Control heights x^2 + x y make the B-spline x^2 + 1/3 + x y in the inside.
  const PolygonMesh surface =
      limit_surface(grid(8, [](float x, float y) { return x * x + x * y; }), 2);
  CHECK(surface.face_sizes.size() == 64 * 16);
  int inside = 0;
  for (std::size_t i = 0; i < surface.positions.size(); ++i) {
    const Vec3& p = surface.positions[i];
    if (p.x < 1 || p.x > 7 || p.y < 1 || p.y > 7) continue;
    ++inside;
    CHECK(p.z == Approx(p.x * p.x + p.x * p.y + 1.0 / 3).margin(1e-5));
    const Vec3 normal = Vec3(-2 * p.x - p.y, -p.x, 1).normalized();
    CHECK((surface.normals[i] - normal).length() < 1e-5F);
  }
  CHECK(inside == 25 * 25);
}

TEST_CASE("materials and the first corner follow the parents") {
  const PolygonMesh surface = limit_surface(grid(4, [](float, float) { return 0.0F; }), 2);
  for (std::size_t f = 0; f < surface.face_sizes.size(); ++f) {
    REQUIRE(surface.face_sizes[f] == 4);
    const Vec3& first = surface.positions[surface.corners[4 * f]];
    const Vec3& third = surface.positions[surface.corners[4 * f + 2]];
    CHECK(first.x < third.x);
    CHECK(first.y < third.y);
    CHECK(surface.materials[f] == (first.x < 2 ? 0 : 1));
  }
}

TEST_CASE("only the kept faces come back, shaped by the others") {
  const PolygonMesh cage = grid(8, [](float x, float) { return x * x; });
  const PolygonMesh whole = limit_surface(cage, 1);
  const PolygonMesh part = limit_surface(cage, 1, 20);
  CHECK(part.face_sizes.size() == 20 * 4);
  for (std::size_t i = 0; i < part.corners.size(); ++i) {
    CHECK(part.positions[part.corners[i]] == whole.positions[whole.corners[i]]);
  }
}

TEST_CASE("a cube's limit surface is closed, and its normals point out") {
  PolygonMesh cube;
  cube.material_names = {"default"};
  for (int i = 0; i < 8; ++i) cube.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  cube.corners = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
  cube.face_sizes.assign(6, 4);
  cube.materials.assign(6, 0);
  const PolygonMesh surface = limit_surface(cube, 3);
  CHECK(surface.positions.size() == 6 * 64 + 2);  // Euler: V = F + 2
  for (std::size_t i = 0; i < surface.positions.size(); ++i) {
    CHECK(surface.normals[i].length() == Approx(1));
    CHECK(surface.normals[i].dot(surface.positions[i] - Vec3(0.5)) > 0);
  }
}
