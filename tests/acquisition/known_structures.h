// Mesostructures made by formula here, independently of the project's own types.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "acquisition/mesostructure.h"

namespace weft::test {

inline Mesostructure structure(TriangleMesh mesh, std::vector<Bsdf> materials,
                               float reference_height) {
  Mesostructure result;
  result.type = "test";
  result.mesh = std::move(mesh);
  result.materials = std::move(materials);
  result.reference_height = reference_height;
  result.settings = "{}";
  return result;
}

inline Mesostructure flat(const Rgb& albedo) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.materials = {0, 0};
  mesh.material_names = {"default"};
  return structure(mesh, {Bsdf::lambert(albedo)}, 0);
}

/// A height field of n x n quads, each cut from (x min, y min) to (x max, y max).
template <typename Height, typename Material>
TriangleMesh height_field(int n, const Height& height, const Material& material) {
  TriangleMesh mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = static_cast<double>(i) / n;
      const double y = static_cast<double>(j) / n;
      mesh.positions.emplace_back(static_cast<float>(x), static_cast<float>(y),
                                  static_cast<float>(height(x, y)));
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (n + 1) + i);
      const std::uint32_t b = a + 1;
      const auto c = static_cast<std::uint32_t>(a + n + 2);
      const auto d = static_cast<std::uint32_t>(a + n + 1);
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
      const auto m = static_cast<std::uint16_t>(material((i + 0.5) / n, (j + 0.5) / n));
      mesh.materials.insert(mesh.materials.end(), {m, m});
    }
  }
  return mesh;
}

/// The checker of the other renderer's pictures.
inline Mesostructure checker(int n = 256) {
  const auto s = [](double x, double y) {
    return std::sin(2 * std::numbers::pi * x) * std::sin(2 * std::numbers::pi * y);
  };
  TriangleMesh mesh = height_field(
      n,
      [&](double x, double y) {
        return 0.075 * (1 + s(x, y) / std::sqrt(s(x, y) * s(x, y) + 0.02));
      },
      [&](double x, double y) { return s(x, y) > 0 ? 0 : 1; });
  mesh.material_names = {"raised", "low"};
  return structure(mesh, {Bsdf::lambert({0.8F, 0.45F, 0.5F}), Bsdf::lambert({0.15F, 0.2F, 0.7F})},
                   0.15F);
}

inline void add_torus(TriangleMesh& mesh, double major, double minor, int n_major, int n_minor) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int i = 0; i < n_major; ++i) {
    const double u = 2 * std::numbers::pi * i / n_major;
    for (int j = 0; j < n_minor; ++j) {
      const double v = 2 * std::numbers::pi * j / n_minor;
      const double r = major + minor * std::cos(v);
      mesh.positions.emplace_back(static_cast<float>(0.5 + r * std::cos(u)),
                                  static_cast<float>(0.5 + r * std::sin(u)),
                                  static_cast<float>(0.03 + minor * std::sin(v)));
    }
  }
  const auto index = [&](int i, int j) {
    return first + static_cast<std::uint32_t>((i % n_major) * n_minor + j % n_minor);
  };
  for (int i = 0; i < n_major; ++i) {
    for (int j = 0; j < n_minor; ++j) {
      mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
      mesh.materials.insert(mesh.materials.end(), {1, 1});
    }
  }
}

/// The rings of the other renderer's pictures.
inline Mesostructure rings(int n_major = 1024, int n_minor = 128) {
  TriangleMesh mesh = flat(Rgb(1)).mesh;
  for (const double major : {0.1, 0.2, 0.3, 0.4}) add_torus(mesh, major, 0.03, n_major, n_minor);
  mesh.material_names = {"base", "ring"};
  return structure(mesh, {Bsdf::lambert({0.1F, 0.15F, 0.6F}), Bsdf::lambert({0.9F, 0.7F, 0.2F})},
                   0.06F);
}

/// A spherical pit of radius `radius` below z = 0 in a flat rim, open where the angle from the
/// sphere's top is below `half_opening`: a hemisphere, or a flask where that is less; material 0
/// the pit, 1 the rim.
inline TriangleMesh pit(double radius, int n, double half_opening = std::numbers::pi / 2) {
  TriangleMesh mesh;
  mesh.material_names = {"pit", "rim"};
  const auto point = [&](double x, double y, double z) {
    mesh.positions.emplace_back(static_cast<float>(x), static_cast<float>(y),
                                static_cast<float>(z));
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  };
  const int around = 4 * n;
  std::vector<std::vector<std::uint32_t>> rows;
  for (int j = 0; j <= n; ++j) {
    const double angle = half_opening + (std::numbers::pi - half_opening) * j / n;  // from the top
    std::vector<std::uint32_t> row;
    for (int i = 0; i < around; ++i) {
      const double phi = 2 * std::numbers::pi * i / around;
      row.push_back(point(0.5 + radius * std::sin(angle) * std::cos(phi),
                          0.5 + radius * std::sin(angle) * std::sin(phi),
                          radius * (std::cos(angle) - std::cos(half_opening))));
    }
    rows.push_back(row);
  }
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d,
                        std::uint16_t m) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
    mesh.materials.insert(mesh.materials.end(), {m, m});
  };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < around; ++i) {
      const int k = (i + 1) % around;
      quad(rows[j][i], rows[j][k], rows[j + 1][k], rows[j + 1][i], 0);
    }
  }
  std::vector<std::uint32_t> border;
  for (int i = 0; i < around; ++i) {
    const double phi = 2 * std::numbers::pi * i / around;
    const double reach = 0.5 / std::max(std::abs(std::cos(phi)), std::abs(std::sin(phi)));
    border.push_back(point(0.5 + reach * std::cos(phi), 0.5 + reach * std::sin(phi), 0));
  }
  for (int i = 0; i < around; ++i) {
    const int k = (i + 1) % around;
    quad(rows[0][k], rows[0][i], border[i], border[k], 1);
  }
  return mesh;
}

}  // namespace weft::test
