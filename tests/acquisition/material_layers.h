// How high the parts of a mesostructure lie along vertical lines: for tests of what lies over what.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tracer/triangle_mesh.h"

/// Lowest and highest z of a material on the vertical lines through the middles of a grid's cells
/// over the tile; where a line does not meet it, lower > upper.
class MaterialLayers {
 public:
  static constexpr int size = 512;
  struct Range {
    float lower = 1e9F;
    float upper = -1e9F;
    bool empty() const { return lower > upper; }
  };

  /// What sticks out of the tile wraps.
  MaterialLayers(const weft::TriangleMesh& mesh, const std::string& material)
      : cells_(size * size) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.material_names[mesh.materials[t]] != material) continue;
      const auto& v = mesh.triangles[t];
      add({mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]});
    }
  }
  const Range& at(int x, int y) const { return cells_[static_cast<std::size_t>(y) * size + x]; }

 private:
  static double cross(const weft::Vec3& a, const weft::Vec3& b, double x, double y) {
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
  }

  void add(const std::array<weft::Vec3, 3>& p) {
    const auto first = [](float v) { return static_cast<int>(std::ceil(v * size - 0.5F)); };
    const auto [x0, x1] = std::minmax({p[0].x, p[1].x, p[2].x});
    const auto [y0, y1] = std::minmax({p[0].y, p[1].y, p[2].y});
    const double area = cross(p[0], p[1], p[2].x, p[2].y);
    if (area == 0) return;
    for (int j = first(y0); j < first(y1); ++j) {
      for (int i = first(x0); i < first(x1); ++i) {
        const double x = (i + 0.5) / size;
        const double y = (j + 0.5) / size;
        const double a = cross(p[1], p[2], x, y) / area;
        const double b = cross(p[2], p[0], x, y) / area;
        if (a < 0 || b < 0 || a + b > 1) continue;
        const auto z = static_cast<float>(a * p[0].z + b * p[1].z + (1 - a - b) * p[2].z);
        const auto wrapped = [](int cell) { return (cell % size + size) % size; };
        Range& range = cells_[static_cast<std::size_t>(wrapped(j)) * size + wrapped(i)];
        range.lower = std::min(range.lower, z);
        range.upper = std::max(range.upper, z);
      }
    }
  }

  std::vector<Range> cells_;
};
