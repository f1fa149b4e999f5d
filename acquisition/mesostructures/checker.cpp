// A smoothed checker pattern as a height field: raised pads and low parts of another material.
//
// With s = sin(2 pi x) sin(2 pi y), the height is z = H/2 (1 + s / sqrt(s^2 + k)): flat pads where
// k is small.
#include <cmath>
#include <numbers>

#include "acquisition/mesostructures/height_grid.h"
#include "acquisition/mesostructures/types.h"

namespace weft {

namespace {

struct Checker {
  double height;
  double smoothing;
  int resolution;

  double angle(double index) const { return 2 * std::numbers::pi * index / resolution; }
  double pattern(double i, double j) const { return std::sin(angle(i)) * std::sin(angle(j)); }

  double z(int i, int j) const {
    const double s = pattern(i, j);
    return height / 2 * (1 + s / std::sqrt(s * s + smoothing));
  }

  Vec3 normal(int i, int j) const {
    const double s = pattern(i, j);
    const double dz_ds = height / 2 * smoothing / std::pow(s * s + smoothing, 1.5);
    const double ds_dx = 2 * std::numbers::pi * std::cos(angle(i)) * std::sin(angle(j));
    const double ds_dy = 2 * std::numbers::pi * std::sin(angle(i)) * std::cos(angle(j));
    return Vec3(Imath::V3d(-dz_ds * ds_dx, -dz_ds * ds_dy, 1).normalized());
  }
};

TriangleMesh build_checker(const Settings& settings) {
  const Checker checker{settings.number("height", 0.15, 0, 10),
                        settings.number("smoothing", 0.02, 1e-6, 100),
                        static_cast<int>(settings.integer("resolution", 256, 4, 4096))};
  const int n = checker.resolution;
  PolygonMesh grid = height_grid(n, n, 0, [&](int i, int j) { return checker.z(i, j); });
  grid.material_names = {"raised", "low"};
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) grid.normals.push_back(checker.normal(i % n, j % n));
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const bool raised = checker.pattern(i + 0.5, j + 0.5) > 0;
      grid.materials[static_cast<std::size_t>(j) * n + i] = raised ? 0 : 1;
    }
  }
  return triangulate(grid);
}

}  // namespace

MesostructureType checker_type() {
  return {"checker",
          "smoothed checker pattern: raised pads over low parts",
          "height = 0.15       of the pads over the low parts, in tiles\n"
          "smoothing = 0.02    k of s / sqrt(s^2 + k): smaller is steeper\n"
          "resolution = 256    quads along each side of the tile",
          build_checker,
          {{"raised", "type = 'plastic'\nalbedo = [0.8, 0.45, 0.5]\nior = 1.5\nalpha = 0.15"},
           {"low", "type = 'plastic'\nalbedo = [0.15, 0.2, 0.7]\nior = 1.5\nalpha = 0.5"}}};
}

}  // namespace weft
