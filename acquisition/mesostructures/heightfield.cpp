// A height field from any image: pixel centres are vertices, and the image repeats without end.
//
// Heights are the linear values of the first channel, or the luminance (Rec. 709) of three or more.
#include <fmt/format.h>

#include <cmath>

#include "acquisition/mesostructures/height_grid.h"
#include "acquisition/mesostructures/periodic.h"
#include "acquisition/mesostructures/types.h"
#include "btf/error.h"
#include "images/image_file.h"

namespace weft {

namespace {

float height_value(const Image& image, int x, int y) {
  const float* value = &image.values[image.offset(x, y)];
  if (image.channels < 3 || (value[0] == value[1] && value[1] == value[2])) return value[0];
  return 0.2126F * value[0] + 0.7152F * value[1] + 0.0722F * value[2];
}

void require_finite(const Image& image, const std::filesystem::path& file) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float value = height_value(image, x, y);
      if (std::isfinite(value)) continue;
      throw bad_input(
          file.string(),
          fmt::format("the height of pixel ({}, {}) is {}, expected a finite number", x, y, value),
          "pixels count from (0, 0) at the top left");
    }
  }
}

TriangleMesh build_heightfield(const Settings& settings) {
  const std::filesystem::path file = settings.existing_path("file");
  const double height = settings.number("height", 0.1, -10, 10);
  const auto levels = static_cast<int>(settings.integer("subdivide", 0, 0, 6));
  const Image image = read_image(file, Encoding::linear);
  if (image.width < 1 || image.height < 1 || image.channels < 1) {
    throw bad_input(file.string(), "the image has no pixels");
  }
  require_finite(image, file);
  // Row 0 is the top, which is near v = 1; the grid's rows rise with v.
  const auto z = [&](int column, int row) {
    return height * static_cast<double>(height_value(image, column, image.height - 1 - row));
  };
  const PolygonMesh grid = height_grid(image.width, image.height, 0.5, z);
  if (levels > 0) return triangulate(periodic_limit_surface(grid, levels));
  TriangleMesh mesh = triangulate(grid);
  set_periodic_normals(mesh);
  return mesh;
}

}  // namespace

MesostructureType heightfield_type() {
  return {"heightfield",
          "height field from an image (first channel, or the luminance of a colour image)",
          "file              the image, relative to this file\n"
          "height = 0.1      of the value 1 over the value 0, in tiles; 8 and 16-bit images are "
          "linear 0..1\n"
          "subdivide = 0     levels of Catmull-Clark subdivision, then the limit surface; 0: none",
          build_heightfield,
          {{"default", "type = 'lambert'\nalbedo = 0.5"}}};
}

}  // namespace weft
