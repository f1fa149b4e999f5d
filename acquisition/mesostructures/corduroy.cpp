// Corduroy as a height field: wales of cut pile along y, and the ground of the cloth between them.
//
// A wale's cross-section is half an ellipse with its foot rounded into the ground. Its pile stands
// in tufts (random cells, wider than long) whose cut ends are uneven; its edges wander slowly, and
// on them single tufts stand out.
#include <cmath>

#include "acquisition/mesostructures/cells.h"
#include "acquisition/mesostructures/height_grid.h"
#include "acquisition/mesostructures/noise.h"
#include "acquisition/mesostructures/periodic.h"
#include "acquisition/mesostructures/types.h"
#include "btf/random.h"

namespace weft {

namespace {

struct Corduroy {
  int wales;
  double height;  // of the pile, in tiles
  double width;   // of a wale, in spacings
  double wobble;  // of a wale's middle, in spacings
  double tuft;    // depth between tufts, of `height`
  double fuzz;    // unevenness of the cut ends, of `height`
  int rows;       // of tufts along a wale
  std::uint64_t seed;
  PeriodicCells tufts;

  /// Distance from the wale's middle, in its half widths: over 1 is ground.
  double beside(const Imath::V2d& p) const {
    const double wander = wobble * periodic_noise(p, {wales, 4}, hash_coordinates(seed, 2));
    const double uneven =
        0.5 * wobble *
        periodic_fractal_noise(p, {4 * wales, rows / 2}, 2, hash_coordinates(seed, 3));
    const double place = p.x * wales + wander + uneven;
    return 2 * std::abs(place - std::floor(place) - 0.5) / width;
  }

  /// Height of the pile's envelope, 0 to 1: sqrt(max(0, 1 - beside^2)), the maximum rounded.
  double envelope(const Imath::V2d& p) const {
    const double inside = 1 - beside(p) * beside(p);
    constexpr double foot = 0.15;
    return std::sqrt((inside + std::sqrt(inside * inside + foot * foot)) / 2);
  }

  double z(const Imath::V2d& p) const {
    const double cut =
        tuft * (tufts.at(p).rise(0.5) - 1) +
        fuzz * periodic_fractal_noise(p, {10 * wales, rows}, 2, hash_coordinates(seed, 4));
    return height * envelope(p) * (1 + cut);
  }
};

TriangleMesh build_corduroy(const Settings& settings) {
  const auto wales = static_cast<int>(settings.integer("wales", 5, 1, 64));
  const auto rows = static_cast<int>(settings.integer("tuft_rows", 48, 8, 512));
  const auto seed = static_cast<std::uint64_t>(settings.integer("seed", 1, 0, 1'000'000));
  const Corduroy corduroy{
      .wales = wales,
      .height = settings.number("height", 0.42, 0, 4) / wales,
      .width = settings.number("width", 0.88, 0.2, 1),
      .wobble = settings.number("wobble", 0.06, 0, 1),
      .tuft = settings.number("tuft_depth", 0.08, 0, 0.8),
      .fuzz = settings.number("fuzz", 0.045, 0, 0.5),
      .rows = rows,
      .seed = seed,
      .tufts = PeriodicCells({6 * wales, rows}, 0.9, hash_coordinates(seed, 1))};
  const auto n = static_cast<int>(settings.integer("resolution", 384, 16, 4096));
  PolygonMesh grid = height_grid(n, n, 0, [&](int i, int j) {
    return corduroy.z({static_cast<double>(i) / n, static_cast<double>(j) / n});
  });
  grid.material_names = {"pile", "ground"};
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const bool pile = corduroy.beside({(i + 0.5) / n, (j + 0.5) / n}) < 1;
      grid.materials[static_cast<std::size_t>(j) * n + i] = pile ? 0 : 1;
    }
  }
  TriangleMesh mesh = triangulate(grid);
  set_periodic_normals(mesh);
  return mesh;
}

}  // namespace

MesostructureType corduroy_type() {
  return {"corduroy",
          "corduroy: wales of cut pile, and ground between them",
          "wales = 5           along y in a tile\n"
          "height = 0.42       of the pile, in spacings of the wales\n"
          "width = 0.88        of a wale, in spacings\n"
          "wobble = 0.06       of the wales' middles, in spacings\n"
          "tuft_rows = 48      of tufts along a wale; six stand across it\n"
          "tuft_depth = 0.08   of the gaps between tufts, in heights of the pile\n"
          "fuzz = 0.045        unevenness of the cut ends, in heights of the pile\n"
          "seed = 1            of all that is random\n"
          "resolution = 384    quads along each side of the tile",
          build_corduroy,
          {{"pile", "type = 'lambert'\nalbedo = [0.3, 0.16, 0.07]"},
           {"ground", "type = 'lambert'\nalbedo = [0.16, 0.08, 0.035]"}}};
}

}  // namespace weft
