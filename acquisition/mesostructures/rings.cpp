// Concentric rings (tori) that lie on a base plane.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "acquisition/mesostructures/plane.h"
#include "acquisition/mesostructures/types.h"
#include "btf/error.h"

namespace weft {

namespace {

struct Torus {
  double major;
  double minor;
  int segments;
  int minor_segments;
};

void add_quad(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
              std::uint32_t d, std::uint16_t material) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
  mesh.materials.insert(mesh.materials.end(), 2, material);
}

/// Axis z through (0.5, 0.5); lies on the plane z = 0.
void add_torus(TriangleMesh& mesh, const Torus& torus, std::uint16_t material) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int i = 0; i < torus.segments; ++i) {
    const double u = 2 * std::numbers::pi * i / torus.segments;
    for (int j = 0; j < torus.minor_segments; ++j) {
      const double v = 2 * std::numbers::pi * j / torus.minor_segments;
      const Imath::V3d normal(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v));
      const Imath::V3d ring(0.5 + torus.major * std::cos(u), 0.5 + torus.major * std::sin(u),
                            torus.minor);
      mesh.positions.emplace_back(ring + normal * torus.minor);
      mesh.normals.emplace_back(normal);
    }
  }
  const auto vertex = [&](int i, int j) {
    return first + static_cast<std::uint32_t>((i % torus.segments) * torus.minor_segments +
                                              j % torus.minor_segments);
  };
  for (int i = 0; i < torus.segments; ++i) {
    for (int j = 0; j < torus.minor_segments; ++j) {
      add_quad(mesh, vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1),
               material);
    }
  }
}

TriangleMesh build_rings(const Settings& settings) {
  std::vector<double> radii = {0.1, 0.2, 0.3, 0.4};
  if (settings.has("radii")) radii = settings.numbers("radii");
  Torus torus{0, settings.number("minor_radius", 0.03, 1e-4, 0.5),
              static_cast<int>(settings.integer("segments", 1024, 3, 8192)),
              static_cast<int>(settings.integer("minor_segments", 128, 3, 2048))};
  TriangleMesh mesh;
  mesh.material_names = {"base", "rings"};
  add_plane(mesh, 0, 0);
  for (const double radius : radii) {
    if (radius < torus.minor || radius > 2) {
      throw bad_input(settings.where("radii"),
                      fmt::format("a radius is {}, expected {} to 2", radius, torus.minor),
                      "not below minor_radius");
    }
    torus.major = radius;
    add_torus(mesh, torus, 1);
  }
  return mesh;
}

}  // namespace

MesostructureType rings_type() {
  return {"rings",
          "concentric rings on a base plane",
          "radii = [0.1, 0.2, 0.3, 0.4]   of the rings' centre lines around (0.5, 0.5), in tiles\n"
          "minor_radius = 0.03            half the thickness of a ring\n"
          "segments = 1024                quads along a ring\n"
          "minor_segments = 128           quads around its cross-section",
          build_rings,
          {{"base", "type = 'plastic'\nalbedo = [0.1, 0.15, 0.6]\nior = 1.5\nalpha = 0.15"},
           {"rings", "type = 'conductor'\nf0 = [1.0, 0.78, 0.34]\nalpha = 0.2"}}};
}

}  // namespace weft
