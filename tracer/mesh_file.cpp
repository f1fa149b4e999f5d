#include "tracer/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "btf/error.h"
#include "tracer/obj_file.h"
#include "tracer/ply_file.h"

namespace weft {

namespace {

std::string extension(const std::filesystem::path& path) {
  std::string name = path.extension().string();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

void require_file(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path))
    throw bad_input(path.string(), "is a folder, not a mesh file");
  if (!is_mesh_file(path)) {
    throw bad_input(path.string(), "is no mesh file that is known here", "known: .obj, .ply");
  }
  if (!std::ifstream(path)) {
    throw bad_input(path.string(), "cannot be opened: " + system_reason(errno));
  }
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void require_sound(const PolygonMesh& mesh, const std::string& file) {
  if (mesh.face_sizes.empty()) throw bad_input(file, "mesh has no faces");
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (is_finite(mesh.positions[i])) continue;
    throw bad_input(file,
                    fmt::format("position of vertex {} is ({}, {}, {}), expected finite numbers", i,
                                mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z));
  }
  for (std::size_t i = 0; i < mesh.texcoords.size(); ++i) {
    if (std::isfinite(mesh.texcoords[i].x) && std::isfinite(mesh.texcoords[i].y)) continue;
    throw bad_input(file, fmt::format("texcoord of vertex {} is not finite", i));
  }
}

/// A unit vector perpendicular to a unit vector (Duff et al. 2017, without a branch at the poles).
Vec3 perpendicular(const Vec3& n) {
  const float sign = std::copysign(1.0F, n.z);
  const float a = -1.0F / (sign + n.z);
  return {1.0F + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x};
}

using Vec3d = Imath::V3d;

Vec3d area_normal(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Vec3d p(mesh.positions[t[0]]);
  return (Vec3d(mesh.positions[t[1]]) - p).cross(Vec3d(mesh.positions[t[2]]) - p);
}

void fill_normals(TriangleMesh& mesh) {
  std::vector<Vec3d> sums(mesh.positions.size(), Vec3d(0));
  for (const auto& triangle : mesh.triangles) {
    const Vec3d normal = area_normal(mesh, triangle);
    for (const std::uint32_t vertex : triangle) sums[vertex] += normal;
  }
  mesh.normals.clear();
  for (const Vec3d& sum : sums) {
    // A vertex of no area has no normal; it is never seen either.
    mesh.normals.push_back(sum.length() > 0 ? Vec3(sum.normalized()) : Vec3(0, 0, 1));
  }
}

/// dP/du of a triangle times its area: constant over it, from its two edges in space and in (u, v).
Vec3d area_tangent(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Imath::V2d uv(mesh.texcoords[t[0]]);
  const Imath::V2d d1 = Imath::V2d(mesh.texcoords[t[1]]) - uv;
  const Imath::V2d d2 = Imath::V2d(mesh.texcoords[t[2]]) - uv;
  const double determinant = d1.x * d2.y - d1.y * d2.x;
  if (determinant == 0) return Vec3d(0);
  const Vec3d p(mesh.positions[t[0]]);
  const Vec3d e1 = Vec3d(mesh.positions[t[1]]) - p;
  const Vec3d e2 = Vec3d(mesh.positions[t[2]]) - p;
  const Vec3d tangent = (e1 * d2.y - e2 * d1.y) * (determinant > 0 ? 1.0 : -1.0);
  return tangent.length() > 0 ? tangent.normalized() * e1.cross(e2).length() : Vec3d(0);
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& path) {
  const std::string name = extension(path);
  return name == ".obj" || name == ".ply";
}

PolygonMesh read_polygons(const std::filesystem::path& path) {
  require_file(path);
  PolygonMesh mesh = extension(path) == ".obj" ? read_obj(path) : read_ply(path);
  require_sound(mesh, path.string());
  return mesh;
}

TriangleMesh read_mesh(const std::filesystem::path& path) {
  return triangulate(read_polygons(path));
}

void complete_frames(TriangleMesh& mesh) {
  if (mesh.normals.empty()) fill_normals(mesh);
  std::vector<Vec3d> sums(mesh.positions.size(), Vec3d(0));
  if (!mesh.texcoords.empty()) {
    for (const auto& triangle : mesh.triangles) {
      const Vec3d tangent = area_tangent(mesh, triangle);
      for (const std::uint32_t vertex : triangle) sums[vertex] += tangent;
    }
  }
  mesh.tangents.clear();
  for (std::size_t i = 0; i < sums.size(); ++i) {
    mesh.tangents.push_back(sums[i].length() > 0 ? Vec3(sums[i].normalized())
                                                 : perpendicular(mesh.normals[i]));
  }
}

}  // namespace weft
