// Grained leather as a height field: rounded pebbles of many sizes with creases between them.
//
// Two layers of cells: the large pebbles, and finer ones that wrinkle their tops. Both are bent by
// slow noise, so that creases are curved as on skin, and no height has an edge.
#include "acquisition/mesostructures/cells.h"
#include "acquisition/mesostructures/height_grid.h"
#include "acquisition/mesostructures/noise.h"
#include "acquisition/mesostructures/periodic.h"
#include "acquisition/mesostructures/types.h"
#include "btf/random.h"

namespace weft {

namespace {

struct Leather {
  double height;    // of the pebbles over the creases, in tiles
  double crease;    // width, in pebbles
  double wrinkles;  // height of the fine pebbles, of `height`
  double bend;      // of the creases, in pebbles
  int pebbles;
  std::uint64_t seed;
  PeriodicCells large;
  PeriodicCells fine;

  double z(const Imath::V2d& p) const {
    const Imath::V2i slow(pebbles / 2, pebbles / 2);
    const Imath::V2d move(periodic_fractal_noise(p, slow, 3, hash_coordinates(seed, 3)),
                          periodic_fractal_noise(p, slow, 3, hash_coordinates(seed, 4)));
    const Imath::V2d bent = p + move * (bend / pebbles);
    const CellPlace pebble = large.at(bent);
    // A narrow crease at the foot of a wide dome, each pebble of its own height.
    const double own = 0.75 + 0.25 * static_cast<double>(unit_float(pebble.hash));
    const double dome = 0.5 * pebble.rise(crease) + 0.5 * own * pebble.rise(3 * crease);
    return height * (dome + wrinkles * fine.at(bent).rise(2 * crease) * (0.3 + 0.7 * dome));
  }
};

TriangleMesh build_leather(const Settings& settings) {
  const auto pebbles = static_cast<int>(settings.integer("pebbles", 12, 4, 64));
  const auto seed = static_cast<std::uint64_t>(settings.integer("seed", 1, 0, 1'000'000));
  const double jitter = settings.number("irregularity", 0.8, 0, 1);
  const Imath::V2i squares(pebbles, pebbles);
  const Leather leather{.height = settings.number("height", 0.016, 0, 1),
                        .crease = settings.number("crease", 0.12, 0.02, 1),
                        .wrinkles = settings.number("wrinkles", 0.06, 0, 1),
                        .bend = settings.number("bend", 0.4, 0, 2),
                        .pebbles = pebbles,
                        .seed = seed,
                        .large = PeriodicCells(squares, jitter, hash_coordinates(seed, 1)),
                        .fine = PeriodicCells(squares * 3, jitter, hash_coordinates(seed, 2))};
  const auto n = static_cast<int>(settings.integer("resolution", 384, 16, 4096));
  TriangleMesh mesh = triangulate(height_grid(n, n, 0, [&](int i, int j) {
    return leather.z({static_cast<double>(i) / n, static_cast<double>(j) / n});
  }));
  mesh.material_names = {"leather"};
  set_periodic_normals(mesh);
  return mesh;
}

}  // namespace

MesostructureType leather_type() {
  return {"leather",
          "grained leather: pebbles with creases between them",
          "pebbles = 12        along each side of the tile\n"
          "height = 0.016      of the highest pebbles over the creases, in tiles\n"
          "crease = 0.12       width of the creases, in pebbles\n"
          "irregularity = 0.8  0: pebbles in rows and columns, 1: anywhere\n"
          "bend = 0.4          of the creases, in pebbles\n"
          "wrinkles = 0.06     height of the fine grain on the pebbles, of theirs\n"
          "seed = 1            of all that is random\n"
          "resolution = 384    quads along each side of the tile",
          build_leather,
          {{"leather", "type = 'plastic'\nalbedo = [0.2, 0.065, 0.025]\nior = 1.5\nalpha = 0.25"}}};
}

}  // namespace weft
