// Files for the tests of mesostructures.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

inline std::filesystem::path mesostructure_folder() {
  return std::filesystem::path(WEFT_SOURCE_DIR) / "scenes" / "mesostructures";
}

/// The names of the project's mesostructure files, sorted: `NAME.toml`.
inline std::vector<std::string> mesostructure_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(mesostructure_folder())) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Writes a file into a folder that is gone with the test; its path.
inline std::filesystem::path write_file(const TemporaryFolder& folder, const std::string& name,
                                        const std::string& content) {
  std::ofstream(folder.path / name, std::ios::binary) << content;
  return folder.path / name;
}

/// An OBJ of a hemispherical pit of a radius (in tiles, below 0.5) around (0.5, 0.5, 0), material
/// "pit", in a level rim at z = 0 that fills the tile, material "rim". `segments` around the axis,
/// a multiple of 8; `rings` from the rim to the pole.
inline std::string hemispherical_pit_obj(double radius, int segments, int rings) {
  std::string obj;
  const auto vertex = [&obj](double x, double y, double z) {
    obj += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  };
  const auto angle = [segments](int k) { return 2 * std::numbers::pi * k / segments; };
  // Row 0 is the tile's border, row 1 the opening, row `rings` + 1 would be the pole.
  for (int k = 0; k < segments; ++k) {
    const double x = std::cos(angle(k));
    const double y = std::sin(angle(k));
    const double reach = 0.5 / std::max(std::abs(x), std::abs(y));
    vertex(0.5 + reach * x, 0.5 + reach * y, 0);
  }
  for (int r = 0; r < rings; ++r) {
    const double depth = std::numbers::pi / 2 * r / rings;
    for (int k = 0; k < segments; ++k) {
      vertex(0.5 + radius * std::cos(depth) * std::cos(angle(k)),
             0.5 + radius * std::cos(depth) * std::sin(angle(k)), -radius * std::sin(depth));
    }
  }
  vertex(0.5, 0.5, -radius);
  const auto index = [segments](int row, int k) {
    return std::to_string(row * segments + k % segments + 1);
  };
  obj += "usemtl rim\n";
  for (int r = 0; r < rings; ++r) {
    if (r == 1) obj += "usemtl pit\n";
    for (int k = 0; k < segments; ++k) {
      obj += "f " + index(r, k) + " " + index(r, k + 1) + " " + index(r + 1, k + 1) + " " +
             index(r + 1, k) + "\n";
    }
  }
  const std::string pole = std::to_string((rings + 1) * segments + 1);
  for (int k = 0; k < segments; ++k)
    obj += "f " + index(rings, k) + " " + index(rings, k + 1) + " " + pole + "\n";
  return obj;
}
