// A brick wall in running bond: rounded bricks, each of its own tone, tilt and place, and recessed
// mortar.
//
// Each course is moved by half a brick against the one below. The wall stands upright in the tile's
// plane: courses run along x, z points out of the wall, and the mortar lies around z = 0.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/mesostructures/block.h"
#include "acquisition/mesostructures/height_grid.h"
#include "acquisition/mesostructures/noise.h"
#include "acquisition/mesostructures/periodic.h"
#include "acquisition/mesostructures/types.h"
#include "btf/error.h"
#include "btf/random.h"

namespace weft {

namespace {

using Vec3d = Imath::V3d;

struct Wall {
  int bricks, courses;
  double joint;      // width of the mortar, in tiles
  double recess;     // of the mortar behind the bricks, in tiles
  double rounding;   // radius of the bricks' edges, in tiles
  double roughness;  // depth of the bricks' and the mortar's unevenness, in tiles
  double variation;  // 0 to 1: of places and tilts
  double tilt;       // largest, in radians
  double spacing;    // of vertices, in tiles
  std::uint64_t seed;
};

constexpr std::uint16_t tones = 3;
constexpr std::uint16_t mortar = tones;

/// Random numbers of one brick.
struct BrickRandom {
  std::uint64_t hash;
  /// In [-1, 1).
  double even(int dimension) const {
    return 2 * static_cast<double>(unit_float(hash_coordinates(hash, dimension))) - 1;
  }
  std::uint16_t tone() const {
    return static_cast<std::uint16_t>(unit_float(hash_coordinates(hash, -1)) * tones);
  }
};

/// Burnt clay: slow unevenness of the whole brick, and grains on its surface.
double unevenness(const Vec3d& p, const Wall& wall, std::uint64_t seed) {
  const double brick = 1.0 / wall.courses;
  return space_noise(p * (3 / brick), seed) + 0.6 * space_noise(p * (9 / brick), seed + 1) +
         0.4 * space_noise(p * (20 / brick), seed + 2);
}

void add_brick(TriangleMesh& wall_mesh, const TriangleMesh& block, const Wall& wall,
               const Vec3d& centre, const BrickRandom& random) {
  const double about_x = wall.tilt * wall.variation * random.even(0);
  const double about_y = wall.tilt * wall.variation * random.even(1) / 3;
  const double about_z = wall.tilt * wall.variation * random.even(2) / 4;
  const double free = wall.variation * wall.joint / 6;
  const Vec3d place = centre + Vec3d(free * random.even(3), free * random.even(4),
                                     wall.recess * (1 + 0.2 * wall.variation * random.even(5)));
  const auto first = static_cast<std::uint32_t>(wall_mesh.positions.size());
  for (std::size_t i = 0; i < block.positions.size(); ++i) {
    const Vec3d even(block.positions[i]);
    const Vec3d p =
        even + Vec3d(block.normals[i]) * (wall.roughness * unevenness(even, wall, random.hash));
    // The angles are small: turns about the three axes add up.
    const Vec3d turned = p + Vec3d(about_x, about_y, about_z).cross(p);
    wall_mesh.positions.emplace_back(place + turned);
  }
  for (const auto& [a, b, c] : block.triangles)
    wall_mesh.triangles.push_back({first + a, first + b, first + c});
  wall_mesh.materials.insert(wall_mesh.materials.end(), block.triangles.size(), random.tone());
}

TriangleMesh mortar_bed(const Wall& wall) {
  const int n = std::max(16, static_cast<int>(1 / wall.spacing));
  const Imath::V2i grain(n / 8, n / 8);
  PolygonMesh grid = height_grid(n, n, 0, [&](int i, int j) {
    const Imath::V2d p(static_cast<double>(i) / n, static_cast<double>(j) / n);
    return 1.5 * wall.roughness *
           periodic_fractal_noise(p, grain, 2, hash_coordinates(wall.seed, 1));
  });
  TriangleMesh mesh = triangulate(grid);
  mesh.materials.assign(mesh.triangles.size(), mortar);
  return mesh;
}

Wall read_wall(const Settings& settings) {
  Wall wall{};
  wall.bricks = static_cast<int>(settings.integer("bricks", 2, 1, 32));
  wall.courses = static_cast<int>(settings.integer("courses", 6, 2, 64));
  if (wall.courses % 2 != 0) {
    throw bad_input(settings.where("courses"), "'courses' is odd, expected an even number",
                    "running bond repeats every two courses");
  }
  // In heights of a course: the shorter side of a brick and its mortar.
  const double side = std::min(1.0, static_cast<double>(wall.courses) / wall.bricks);
  const double most_joint = 0.5 * side;
  const double joint = settings.number("joint", std::min(0.14, most_joint), 0.01, most_joint);
  wall.joint = joint / wall.courses;
  wall.recess = settings.number("recess", 0.12, 0, 1) / wall.courses;
  const double most_rounding = 0.45 * (side - joint);
  wall.rounding = settings.number("rounding", std::min(0.08, most_rounding), 0.005, most_rounding) /
                  wall.courses;
  wall.roughness = settings.number("roughness", 0.018, 0, 0.05) / wall.courses;
  wall.variation = settings.number("variation", 1, 0, 1);
  wall.tilt = settings.number("tilt", 2, 0, 5) * std::numbers::pi / 180;
  wall.spacing = 1.0 / static_cast<double>(settings.integer("resolution", 192, 32, 2048));
  wall.seed = static_cast<std::uint64_t>(settings.integer("seed", 1, 0, 1'000'000));
  return wall;
}

TriangleMesh build_brick(const Settings& settings) {
  const Wall wall = read_wall(settings);
  // Deep enough that no tilt or recess lifts the back out of the mortar.
  const TriangleMesh block =
      make_block({.width = 1.0 / wall.bricks - wall.joint,
                  .height = 1.0 / wall.courses - wall.joint,
                  .depth = 2 * (wall.recess + wall.rounding) + wall.tilt / (2 * wall.bricks) +
                           6 * wall.roughness,
                  .rounding = wall.rounding,
                  .spacing = wall.spacing});
  TriangleMesh mesh = mortar_bed(wall);
  for (int course = 0; course < wall.courses; ++course) {
    for (int brick = 0; brick < wall.bricks; ++brick) {
      const double x = (brick + (course % 2 == 0 ? 0.5 : 1)) / wall.bricks;
      add_brick(mesh, block, wall, {x, (course + 0.5) / wall.courses, 0},
                {hash_coordinates(wall.seed, 2, course, brick)});
    }
  }
  mesh.material_names = {"brick", "pale_brick", "dark_brick", "mortar"};
  set_periodic_normals(mesh);
  return mesh;
}

}  // namespace

MesostructureType brick_type() {
  return {
      "brick",
      "brick wall in running bond, with recessed mortar",
      "bricks = 2          in a course of the tile\n"
      "courses = 6         in the tile, even; lengths below are in heights of a course\n"
      "joint = 0.14        width of the mortar between bricks; at most half the bricks' shorter "
      "side\n"
      "recess = 0.12       of the mortar behind the bricks' faces\n"
      "rounding = 0.08     radius of the bricks' edges\n"
      "roughness = 0.018   depth of the unevenness of bricks and mortar\n"
      "variation = 1       0: all bricks alike in place and tilt, to 1\n"
      "tilt = 2            largest tilt of a brick, in degrees\n"
      "seed = 1            of all that is random\n"
      "resolution = 192    vertices along each side of the tile",
      build_brick,
      {{"brick", "type = 'lambert'\nalbedo = [0.42, 0.16, 0.1]"},
       {"pale_brick", "type = 'lambert'\nalbedo = [0.47, 0.21, 0.13]"},
       {"dark_brick", "type = 'lambert'\nalbedo = [0.34, 0.125, 0.085]"},
       {"mortar", "type = 'lambert'\nalbedo = [0.5, 0.48, 0.44]"}}};
}

}  // namespace weft
