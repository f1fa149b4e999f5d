#include "acquisition/mesostructures/height_grid.h"

namespace weft {

PolygonMesh height_grid(int columns, int rows, double shift,
                        const std::function<double(int column, int row)>& height) {
  PolygonMesh mesh;
  mesh.material_names = {"default"};
  const auto stride = static_cast<std::uint32_t>(columns) + 1;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      mesh.positions.emplace_back(static_cast<float>((i + shift) / columns),
                                  static_cast<float>((j + shift) / rows),
                                  static_cast<float>(height(i % columns, j % rows)));
    }
  }
  for (std::uint32_t j = 0; j + 1 <= static_cast<std::uint32_t>(rows); ++j) {
    for (std::uint32_t i = 0; i + 1 < stride; ++i) {
      const std::uint32_t first = j * stride + i;
      for (const std::uint32_t corner : {first, first + 1, first + stride + 1, first + stride}) {
        mesh.corners.push_back(corner);
      }
      mesh.face_sizes.push_back(4);
      mesh.materials.push_back(0);
    }
  }
  return mesh;
}

}  // namespace weft
