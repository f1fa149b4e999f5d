// Shapes: closed, outward, with frames that follow the texture coordinates.

#include <array>
#include <map>

#include "btf/direction.h"
#include "btf/error.h"
#include "tests/tracer/test_scenes.h"

namespace weft {
namespace {

using Edge = std::array<std::array<float, 3>, 2>;

std::array<float, 3> key(const Vec3& p) {
  return {p.x + 0.0F, p.y + 0.0F, p.z + 0.0F};
}

/// Edges that are not met by one of the opposite direction.
int open_edges(const TriangleMesh& mesh) {
  std::map<Edge, int> edges;
  for (const auto& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const auto a = key(mesh.positions[triangle[i]]),
                 b = key(mesh.positions[triangle[(i + 1) % 3]]);
      ++edges[{a, b}];
      --edges[{b, a}];
    }
  }
  return static_cast<int>(
      std::count_if(edges.begin(), edges.end(), [](const auto& e) { return e.second != 0; }));
}

double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Imath::V3d p(mesh.positions[a]), q(mesh.positions[b]), r(mesh.positions[c]);
    sum += p.dot(q.cross(r)) / 6;
  }
  return sum;
}

/// How the vertices' frames agree with the triangles' positions and texcoords.
struct Frames {
  double least_normal = 1;   ///< cosine between a triangle's normal and its vertices'
  double poor = 0;           ///< share of the area where normals are 10 degrees off or tangents 20
  double normal_error = 0;   ///< 1 - cosine for the vertices' mean normal, mean over the area
  bool right_handed = true;  ///< v grows along n x t everywhere
  bool unit = true;
};
Frames frames(const TriangleMesh& mesh) {
  Frames result;
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 e1 = mesh.positions[b] - mesh.positions[a],
               e2 = mesh.positions[c] - mesh.positions[a];
    const Vec2 d1 = mesh.texcoords[b] - mesh.texcoords[a],
               d2 = mesh.texcoords[c] - mesh.texcoords[a];
    const float determinant = d1.x * d2.y - d1.y * d2.x;
    result.right_handed = result.right_handed && determinant > 0;
    const Vec3 du = ((e1 * d2.y - e2 * d1.y) / determinant).normalized();
    const Vec3 n = e1.cross(e2).normalized();
    double normal = 1, tangent = 1;
    for (const std::uint32_t i : {a, b, c}) {
      normal = std::min<double>(normal, n.dot(mesh.normals[i]));
      tangent = std::min<double>(tangent, du.dot(mesh.tangents[i]));
      result.unit = result.unit && std::abs(mesh.tangents[i].length() - 1) < 1e-5F &&
                    std::abs(mesh.normals[i].length() - 1) < 1e-5F;
    }
    const double size = e1.cross(e2).length();
    area += size;
    result.least_normal = std::min(result.least_normal, normal);
    if (normal < std::cos(radians(10.0)) || tangent < std::cos(radians(20.0))) result.poor += size;
    result.normal_error +=
        size * (1 - n.dot((mesh.normals[a] + mesh.normals[b] + mesh.normals[c]).normalized()));
  }
  result.poor /= area;
  result.normal_error /= area;
  return result;
}

TEST_CASE("Shapes are closed, face outwards and have their volume", "[shapes]") {
  constexpr double pi = std::numbers::pi;
  const TriangleMesh cube = shape_of("type = 'cube'\nsize = 3.0");
  const TriangleMesh sphere = shape_of("type = 'sphere'\nradius = 2.0\nsegments = 256");
  const TriangleMesh torus =
      shape_of("type = 'torus'\nmajor = 2.0\nminor = 0.5\ntube_segments = 256");
  const TriangleMesh shell = shape_of("type = 'seashell'");
  CHECK(volume(cube) == Approx(27));
  CHECK(volume(sphere) == Approx(32.0 / 3 * pi).epsilon(1e-3));
  CHECK(volume(torus) == Approx(2 * pi * pi * 2 * 0.25).epsilon(1e-3));
  CHECK(volume(shell) > 0);
  CHECK(open_edges(cube) == 0);
  CHECK(open_edges(sphere) == 0);
  CHECK(open_edges(torus) == 0);
  CHECK(open_edges(shell) == 0);
  CHECK(open_edges(shape_of("type = 'plane'")) == 8);  // four sides, either way
}

TEST_CASE("Normals and tangents follow the triangles and their texture coordinates", "[shapes]") {
  for (const std::string shape : {"plane", "cube", "sphere", "torus", "seashell"}) {
    CAPTURE(shape);
    const Frames found = frames(shape_of("type = '" + shape + "'"));
    CHECK(found.unit);
    CHECK(found.right_handed);
    // Facets span 2 to 4 degrees; tangents turn faster at a sphere's poles, all at the shell's lip
    // and axis.
    CHECK(found.poor < (shape == "seashell" ? 0.03 : shape == "sphere" ? 0.01 : 1e-9));
    if (shape != "seashell") CHECK(found.least_normal > std::cos(radians(4.0)));
  }
}

TEST_CASE("A seashell's frames converge to its surface", "[shapes]") {
  const auto error = [](int segments) {
    const std::string n = std::to_string(segments);
    return frames(shape_of("type = 'seashell'\nsegments = " + n + "\ntube_segments = " + n))
        .normal_error;
  };
  // The cosine's error is quadratic in the facets' size, but for the lip, whose rings are fixed.
  CHECK(error(48) < 0.35 * error(24));
}

TEST_CASE("A shape is scaled, then turned, then moved", "[shapes]") {
  const TriangleMesh plane = shape_of(
      "type = 'plane'\nsize = [2, 2]\nscale = [3, 1, 1]\nrotate = [90, 0, 90]\ntranslate = [10, 0, "
      "0]");
  // The corner (1, 1, 0) goes to (3, 1, 0), about x to (3, 0, 1), about z to (0, 3, 1).
  const Vec3 corner = plane.positions[3] - Vec3(10, 3, 1);
  CHECK(corner.length() < 1e-5F);
  CHECK((plane.normals[0] - Vec3(1, 0, 0)).length() < 1e-6F);
  CHECK((plane.tangents[0] - Vec3(0, 1, 0)).length() < 1e-6F);
  const Frames stretched = frames(shape_of("type = 'sphere'\nscale = [1, 2, 0.5]\nsegments = 512"));
  CHECK(stretched.unit);
  CHECK(stretched.least_normal > 0.995);
}

TEST_CASE("A cube shows a whole tile upright on each side", "[shapes]") {
  const TriangleMesh cube = shape_of("type = 'cube'");
  REQUIRE(cube.positions.size() == 24);
  for (std::size_t i = 0; i < 24; ++i) {
    if (std::abs(cube.normals[i].z) < 0.5F)
      CHECK(cube.texcoords[i].y == (cube.positions[i].z > 0 ? 1 : 0));
  }
}

TEST_CASE("A mistyped shape lists those there are", "[shapes]") {
  CHECK_THROWS_WITH(shape_of("type = 'tours'"),
                    Catch::Contains("torus") && Catch::Contains("tours"));
  CHECK_THROWS_AS(shape_of("type = 'torus'\nmajor = 1\nminor = 2"), Error);
  CHECK_THROWS_AS(shape_of("type = 'cube'\nscale = 0"), Error);
  CHECK_THROWS_WITH(shape_of("type = 'cube'\nradius = 1"), Catch::Contains("radius"));
}

}  // namespace
}  // namespace weft
