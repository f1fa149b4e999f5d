// Gravel: irregular stones of many sizes that lie on and beside each other over a floor.
//
// Stones are laid one after another, from the largest to the smallest, each at the deepest of some
// random places: small ones so fill the gaps between large ones, as in gravel that was shaken.
#include <cmath>

#include "acquisition/mesostructures/periodic.h"
#include "acquisition/mesostructures/plane.h"
#include "acquisition/mesostructures/stone.h"
#include "acquisition/mesostructures/stone_bed.h"
#include "acquisition/mesostructures/types.h"
#include "btf/random.h"

namespace weft {

namespace {

struct Gravel {
  int stones;
  double smallest, largest;  // radii, in tiles
  StoneForm form;            // but for the radius
  int levels;
  std::uint64_t seed;
};

constexpr int bed_cells = 500;  // a stone reaches into another by less than a cell
constexpr int tried_places = 64;
constexpr std::uint16_t materials_of_stones = 3;

void add_stone(TriangleMesh& mesh, const TriangleMesh& stone, const Vec3& place,
               std::uint16_t material) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3& p : stone.positions) mesh.positions.push_back(p + place);
  for (const auto& [a, b, c] : stone.triangles)
    mesh.triangles.push_back({first + a, first + b, first + c});
  mesh.materials.insert(mesh.materials.end(), stone.triangles.size(), material);
}

TriangleMesh stones_at_rest(const Gravel& gravel) {
  TriangleMesh mesh;
  StoneBed bed(bed_cells);
  for (int i = 0; i < gravel.stones; ++i) {
    const auto random = [&](int dimension, int n) {
      return static_cast<int>(static_cast<float>(n) *
                              unit_float(hash_coordinates(gravel.seed, i, dimension)));
    };
    StoneForm form = gravel.form;
    // Evenly over the logarithm of the size: as many from 1 to 2 as from 2 to 4.
    const double rank = (i + 0.5) / gravel.stones;
    form.radius = gravel.largest * std::pow(gravel.smallest / gravel.largest, rank);
    const TriangleMesh stone = make_stone(form, gravel.levels, hash_coordinates(gravel.seed, i));
    const StoneBed::Footprint footprint = bed.footprint(stone);
    int x = 0;
    int y = 0;
    float height = 0;
    for (int k = 0; k < tried_places; ++k) {
      const int tried_x = random(2 * k, bed_cells);
      const int tried_y = random(2 * k + 1, bed_cells);
      const float tried = bed.rest(footprint, tried_x, tried_y);
      if (k > 0 && tried >= height) continue;
      x = tried_x;
      y = tried_y;
      height = tried;
    }
    bed.lay(footprint, x, y, height);
    const Vec3 place((static_cast<float>(x) + 0.5F) / bed_cells,
                     (static_cast<float>(y) + 0.5F) / bed_cells, height);
    add_stone(mesh, stone, place, static_cast<std::uint16_t>(random(-1, materials_of_stones)));
  }
  return mesh;
}

TriangleMesh build_gravel(const Settings& settings) {
  Gravel gravel{};
  gravel.stones = static_cast<int>(settings.integer("stones", 170, 1, 2000));
  gravel.largest = settings.number("largest", 0.11, 0.01, 0.3);
  gravel.smallest = settings.number("smallest", 0.035, 0.005, gravel.largest);
  gravel.form.flatness = settings.number("flatness", 0.4, 0, 0.8);
  gravel.form.roundness = settings.number("roundness", 0.5, 0.1, 1);
  gravel.form.bumps = settings.number("bumps", 0.06, 0, 0.3);
  gravel.levels = static_cast<int>(settings.integer("subdivide", 3, 1, 6));
  gravel.seed = static_cast<std::uint64_t>(settings.integer("seed", 1, 0, 1'000'000));
  TriangleMesh mesh = stones_at_rest(gravel);
  mesh.material_names = {"stone", "pale_stone", "dark_stone", "floor"};
  set_periodic_normals(mesh);
  add_plane(mesh, 0, materials_of_stones);
  return mesh;
}

}  // namespace

MesostructureType gravel_type() {
  return {"gravel",
          "irregular stones of many sizes at rest on a floor and on each other",
          "stones = 170       in a tile\n"
          "largest = 0.11     radius, in tiles\n"
          "smallest = 0.035   radius, in tiles\n"
          "flatness = 0.4     1 - shortest / longest axis of a stone\n"
          "roundness = 0.5    0.1: broken stone with sharp edges, to 1: pebbles of a river\n"
          "bumps = 0.06       depth of the unevenness of a stone's faces, in radii\n"
          "seed = 1           of all that is random\n"
          "subdivide = 3      a stone has 20 * 4^subdivide triangles",
          build_gravel,
          {{"stone", "type = 'lambert'\nalbedo = [0.36, 0.34, 0.32]"},
           {"pale_stone", "type = 'lambert'\nalbedo = [0.55, 0.51, 0.45]"},
           {"dark_stone", "type = 'lambert'\nalbedo = [0.2, 0.19, 0.2]"},
           {"floor", "type = 'lambert'\nalbedo = [0.22, 0.17, 0.12]"}}};
}

}  // namespace weft
