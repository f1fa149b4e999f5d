#include "tracer/shapes/parametric_surface.h"

namespace weft {
namespace {

void add_triangle(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const Vec3& p = mesh.positions[a];
  const Vec3& q = mesh.positions[b];
  const Vec3& r = mesh.positions[c];
  if (p == q || q == r || r == p) return;
  mesh.triangles.push_back({a, b, c});
  mesh.materials.push_back(0);
}

}  // namespace

TriangleMesh tessellate(int columns, int rows,
                        const std::function<SurfacePoint(int column, int row)>& surface) {
  TriangleMesh mesh;
  mesh.material_names = {"default"};
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      const SurfacePoint point = surface(column, row);
      mesh.positions.push_back(point.position);
      mesh.normals.push_back(point.normal);
      mesh.tangents.push_back(point.tangent);
      mesh.texcoords.push_back(point.texcoord);
    }
  }
  const auto vertex = [&](int column, int row) {
    return static_cast<std::uint32_t>(row) * (columns + 1) + column;
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const std::uint32_t a = vertex(column, row), b = vertex(column + 1, row);
      const std::uint32_t c = vertex(column + 1, row + 1), d = vertex(column, row + 1);
      add_triangle(mesh, a, b, c);
      add_triangle(mesh, a, c, d);
    }
  }
  return mesh;
}

void append(TriangleMesh& whole, const TriangleMesh& part) {
  const auto first = static_cast<std::uint32_t>(whole.positions.size());
  const auto add = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  add(whole.positions, part.positions);
  add(whole.normals, part.normals);
  add(whole.tangents, part.tangents);
  add(whole.texcoords, part.texcoords);
  add(whole.materials, part.materials);
  for (const auto& [a, b, c] : part.triangles) {
    whole.triangles.push_back({a + first, b + first, c + first});
  }
  if (whole.material_names.empty()) whole.material_names = part.material_names;
}

}  // namespace weft
