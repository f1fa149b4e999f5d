#include "tracer/shapes/shape_registry.h"

#include <Imath/ImathMatrix.h>

#include <vector>

#include "btf/direction.h"
#include "btf/error.h"
#include "tracer/shapes/basic_shapes.h"
#include "tracer/shapes/seashell.h"

namespace weft {
namespace {

const char* const plane_parameters = "size = [2, 2]     width along x (u) and along y (v)\n";
const char* const cube_parameters = "size = 2          length of an edge\n";
const char* const sphere_parameters =
    "radius = 1\n"
    "segments = 128    around; half as many from pole to pole\n";
const char* const torus_parameters =
    "major = 1         radius of the circle that the tube follows (u runs along it)\n"
    "minor = 0.4       radius of the tube (v runs around it)\n"
    "segments = 256    along the circle\n"
    "tube_segments = 96\n";
const char* const seashell_parameters =
    "whorls = 4.5      turns of the spiral\n"
    "growth = 1.9      factor of size from one turn to the next\n"
    "radius = 0.9      of the spiral at the aperture\n"
    "tube = [0.85, 0.95]  half axes of the tube's cross-section at the aperture: outwards, along "
    "z\n"
    "height = 2.2      from the apex down to the aperture's centre\n"
    "segments = 96     per turn\n"
    "tube_segments = 96\n";
const char* const mesh_parameters =
    "file              OBJ or PLY, relative to the scene file; tangent frames come from its "
    "texcoords\n";

/// scale, then rotate about x, y and z, then translate; for Imath's row vectors.
Imath::M44d placement(const Settings& settings) {
  const Rgb scale = settings.rgb("scale", {1, 1, 1});
  if (!(scale.x > 0 && scale.y > 0 && scale.z > 0)) {
    throw bad_input(settings.where("scale"), "scale is not above 0");
  }
  const Vec3 degrees = settings.vec3("rotate", {0, 0, 0});
  const Vec3 translate = settings.vec3("translate", {0, 0, 0});
  Imath::M44d matrix;
  matrix.setScale(Imath::V3d(scale.x, scale.y, scale.z));
  const std::array<Imath::V3d, 3> axes{Imath::V3d(1, 0, 0), Imath::V3d(0, 1, 0),
                                       Imath::V3d(0, 0, 1)};
  for (int i = 0; i < 3; ++i) {
    Imath::M44d turn;
    turn.setAxisAngle(axes[i], radians(static_cast<double>(degrees[i])));
    matrix = matrix * turn;
  }
  Imath::M44d shift;
  shift.setTranslation(Imath::V3d(translate));
  return matrix * shift;
}

void place(TriangleMesh& mesh, const Imath::M44d& matrix) {
  const Imath::M44d inverse_transposed = matrix.inverse().transposed();
  for (Vec3& p : mesh.positions) {
    Imath::V3d moved;
    matrix.multVecMatrix(Imath::V3d(p), moved);
    p = Vec3(moved);
  }
  const auto turn = [](Vec3& direction, const Imath::M44d& m) {
    Imath::V3d turned;
    m.multDirMatrix(Imath::V3d(direction), turned);
    direction = Vec3(turned.normalized());
  };
  for (Vec3& n : mesh.normals) turn(n, inverse_transposed);
  for (Vec3& t : mesh.tangents) turn(t, matrix);
}

}  // namespace

std::span<const ShapeType> shape_types() {
  static const std::vector<ShapeType> types{
      {"plane", "a rectangle in z = 0, facing +z", plane_parameters, make_plane},
      {"cube", "a box with flat faces, each a whole [0, 1]^2 of uv", cube_parameters, make_cube},
      {"sphere", "u around z, v from the south to the north pole", sphere_parameters, make_sphere},
      {"torus", "around z; u along the circle, v around the tube", torus_parameters, make_torus},
      {"seashell", "a conch: a tube along a spiral that grows evenly; u along it, v around it",
       seashell_parameters, make_seashell},
      {"mesh", "triangles of an OBJ or PLY file", mesh_parameters, make_file_mesh},
  };
  return types;
}

TriangleMesh make_shape(const Settings& settings) {
  std::vector<std::string> names;
  for (const ShapeType& type : shape_types()) names.push_back(type.name);
  settings.text("type");  // there is no shape by default
  const std::string name = settings.choice("type", names);
  for (const ShapeType& type : shape_types()) {
    if (type.name != name) continue;
    TriangleMesh mesh = type.make(settings);
    place(mesh, placement(settings));
    return mesh;
  }
  throw bad_input(settings.where("type"), "unknown shape '" + name + "'");
}

}  // namespace weft
