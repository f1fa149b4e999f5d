// Intertwined yarns of twisted plies in a plain weave, as subdivision surfaces of swept tubes.
//
// The weft (along x) and the warp (along y) go over and under each other. A yarn's centre line is
// z(t) = A S(cos(pi t)), t in spacings of what it crosses (see yarn.h), and its cross-section lies
// within an ellipse of half width w (in spacings) and half thickness h. Over a crossing the gap
// between the two yarns is g(x) + g(y) with g(t) = A S(cos(pi t)) - h sqrt(1 - t^2/w^2); for
// w <= 0.43 S(cos(pi t)) >= sqrt(1 - t^2/w^2) everywhere, so that yarns never meet where A > h.
#include <cmath>

#include "acquisition/mesostructures/periodic.h"
#include "acquisition/mesostructures/plane.h"
#include "acquisition/mesostructures/types.h"
#include "acquisition/mesostructures/yarn.h"
#include "btf/error.h"

namespace weft {

namespace {

struct Weave {
  int warp, weft;         // yarns a tile, even
  double width;           // of a yarn, in spacings
  double half_thickness;  // h, in tiles
  double amplitude;       // A, in tiles
  double middle;          // height of the weave's middle plane, in tiles
  int plies;
  double ply_depth;
  int twist;     // turns a tile
  int sections;  // control points around a yarn
  int steps;     // control rings a crossing
};

/// One family of yarns: along `axis`; `side` x `axis` points down.
struct FibreFamily {
  Imath::V3d axis, side;
  int count;      // of its yarns a tile
  int crossings;  // yarns of the other family a tile
  int phase;      // 0: the first yarn goes over the first that it crosses
  std::uint16_t material;
};

void add_family(PolygonMesh& cage, const Weave& weave, const FibreFamily& family) {
  const int rings = family.crossings * weave.steps;
  const YarnForm form{.half_width = weave.width / 2 / family.count,
                      .half_thickness = weave.half_thickness,
                      .spacing = 1.0 / family.count,
                      .plies = weave.plies,
                      .ply_depth = weave.ply_depth,
                      .twist = weave.twist,
                      .sections = weave.sections};
  const Imath::V3d across(std::abs(family.side.x), std::abs(family.side.y), 0);
  for (int index = 0; index < family.count; ++index) {
    const double sign = (index + family.phase) % 2 == 0 ? 1 : -1;
    YarnPath path{family.axis, family.side, across * ((index + 0.5) / family.count), {}};
    for (int k = 0; k < rings; ++k) {
      const double from_crossing = static_cast<double>(k) / weave.steps - 0.5;
      path.heights.push_back(weave.middle +
                             sign * weave.amplitude * crossing_height(from_crossing));
    }
    add_yarn(cage, form, path, family.material);
  }
}

int even_count(const Settings& settings, const std::string& key) {
  const std::int64_t count = settings.integer(key, 4, 2, 64);
  if (count % 2 != 0) {
    throw bad_input(settings.where(key), "'" + key + "' is odd, expected an even number",
                    "a plain weave repeats every two yarns");
  }
  return static_cast<int>(count);
}

Weave read_weave(const Settings& settings) {
  Weave weave{};
  weave.warp = even_count(settings, "warp");
  weave.weft = even_count(settings, "weft");
  weave.width = settings.number("width", 0.84, 0.1, 0.85);
  const double spacing = 1.0 / std::max(weave.warp, weave.weft);
  weave.half_thickness = settings.number("thickness", 0.3, 0.02, 2) / 2 * spacing;
  weave.amplitude = weave.half_thickness * (1 + settings.number("gap", 0.04, 0.02, 2));
  weave.middle = weave.amplitude + 1.1 * weave.half_thickness;
  weave.plies = static_cast<int>(settings.integer("plies", 3, 0, 12));
  weave.ply_depth = weave.plies == 0 ? 0 : settings.number("ply_depth", 0.35, 0, 0.8);
  weave.twist = static_cast<int>(settings.integer("twist", 3, -32, 32));
  weave.sections = static_cast<int>(settings.integer("sections", 24, 8, 128));
  weave.steps = static_cast<int>(settings.integer("steps", 16, 8, 128));
  return weave;
}

TriangleMesh build_tissue(const Settings& settings) {
  const Weave weave = read_weave(settings);
  const FibreFamily weft{{1, 0, 0}, {0, -1, 0}, weave.weft, weave.warp, 0, 0};
  const FibreFamily warp{{0, 1, 0}, {1, 0, 0}, weave.warp, weave.weft, 1, 1};
  PolygonMesh cage;
  cage.material_names = {"weft", "warp", "floor"};
  add_family(cage, weave, weft);
  add_family(cage, weave, warp);
  const auto levels = static_cast<int>(settings.integer("subdivide", 1, 1, 4));
  TriangleMesh mesh = triangulate(periodic_limit_surface(cage, levels));
  add_plane(mesh, 0, 2);
  return mesh;
}

}  // namespace

MesostructureType tissue_type() {
  return {"tissue",
          "plain weave of twisted yarns over a floor, as subdivision surfaces",
          "warp = 4          yarns along y in a tile, even\n"
          "weft = 4          yarns along x in a tile, even\n"
          "width = 0.84      of a yarn, in spacings of its neighbours; at most 0.85\n"
          "thickness = 0.3   of a yarn, in the smaller spacing\n"
          "gap = 0.04        between crossing yarns, in yarn thicknesses\n"
          "plies = 3         strands twisted into a yarn; 0: a smooth yarn\n"
          "ply_depth = 0.35  of the grooves between plies, in yarn radii\n"
          "twist = 3         turns of the plies in a tile\n"
          "sections = 24     control points around a yarn\n"
          "steps = 16        control rings from one crossing to the next\n"
          "subdivide = 1     levels of Catmull-Clark subdivision, then the limit surface",
          build_tissue,
          {{"weft", "type = 'plastic'\nalbedo = [0.75, 0.6, 0.42]\nior = 1.5\nalpha = 0.35"},
           {"warp", "type = 'plastic'\nalbedo = [0.6, 0.35, 0.24]\nior = 1.5\nalpha = 0.35"},
           {"floor", "type = 'lambert'\nalbedo = [0.1, 0.08, 0.07]"}}};
}

}  // namespace weft
