// A mesh that the user brings, scaled and placed into the tile.
#include <fmt/format.h>

#include <utility>

#include "acquisition/mesostructures/periodic.h"
#include "acquisition/mesostructures/types.h"
#include "btf/error.h"
#include "tracer/mesh_file.h"

namespace weft {

namespace {

/// Wider meshes are given in another unit: every tile would be crossed by that many copies.
constexpr float widest = 4;

struct Bounds {
  Vec3 lower, upper;
};

Bounds bounds_of(const std::vector<Vec3>& positions) {
  Bounds bounds{positions.front(), positions.front()};
  for (const Vec3& p : positions) {
    for (int axis = 0; axis < 3; ++axis) {
      bounds.lower[axis] = std::min(bounds.lower[axis], p[axis]);
      bounds.upper[axis] = std::max(bounds.upper[axis], p[axis]);
    }
  }
  return bounds;
}

/// y up becomes z up; the unit square of x and z stays the tile.
void turn_up(PolygonMesh& mesh) {
  for (Vec3& p : mesh.positions) p = Vec3(p.x, 1 - p.z, p.y);
  for (Vec3& n : mesh.normals) n = Vec3(n.x, -n.z, n.y);
}

/// Scales all axes alike so that the wider of x and y spans the tile, and puts the lower corner at
/// the origin.
void fit_to_tile(PolygonMesh& mesh, const std::string& where) {
  const Bounds bounds = bounds_of(mesh.positions);
  const Vec3 size = bounds.upper - bounds.lower;
  const float width = std::max(size.x, size.y);
  if (!(width > 0)) throw bad_input(where, "a mesh without width cannot be fitted to the tile");
  for (Vec3& p : mesh.positions) p = (p - bounds.lower) / width;
}

void require_tile_sized(const PolygonMesh& mesh, const std::string& file) {
  const Bounds bounds = bounds_of(mesh.positions);
  const Vec3 size = bounds.upper - bounds.lower;
  if (size.x <= widest && size.y <= widest) return;
  throw bad_input(
      file, fmt::format("the mesh is {} x {} tiles wide, expected about 1 x 1", size.x, size.y),
      "x and y from 0 to 1 cover the tile; `fit = true` or `scale` makes it so");
}

/// The faces as they are, without subdivision.
TriangleMesh flat_faces(PolygonMesh polygons) {
  polygons.texcoords.clear();
  TriangleMesh mesh = triangulate(polygons);
  if (mesh.normals.empty()) set_periodic_normals(mesh);
  return mesh;
}

TriangleMesh build_mesh(const Settings& settings) {
  const std::filesystem::path file = settings.existing_path("file");
  const bool y_up = settings.choice("up", {"z", "y"}) == "y";
  const bool fit = settings.flag("fit", false);
  const auto scale = static_cast<float>(settings.number("scale", 1, 1e-9, 1e9));
  const Vec3 translate = settings.vec3("translate", Vec3(0, 0, 0));
  const auto levels = static_cast<int>(settings.integer("subdivide", 0, 0, 6));

  PolygonMesh polygons = read_polygons(file);
  if (y_up) turn_up(polygons);
  if (fit) fit_to_tile(polygons, settings.where("fit"));
  for (Vec3& p : polygons.positions) p = p * scale + translate;
  require_tile_sized(polygons, file.string());

  TriangleMesh mesh = levels > 0 ? triangulate(periodic_limit_surface(polygons, levels))
                                 : flat_faces(std::move(polygons));
  if (!has_area(mesh)) throw bad_input(file.string(), "the mesh has no triangle with an area");
  return mesh;
}

}  // namespace

MesostructureType mesh_type() {
  return {
      "mesh",
      "triangles and polygons from an OBJ or PLY file",
      "file                    the mesh, relative to this file; x, y in [0, 1] cover the tile\n"
      "up = \"z\"                or \"y\": the file's y axis points up\n"
      "fit = false             scale the wider of x and y to the tile, lower corner at the origin\n"
      "scale = 1               then multiplies all coordinates\n"
      "translate = [0, 0, 0]   then is added, in tiles\n"
      "subdivide = 0           levels of Catmull-Clark subdivision, then the limit surface; 0: "
      "none",
      build_mesh,
      {}};
}

}  // namespace weft
