// Woven cloth from a weave pattern: warp and weft yarns that go over and under as a draft says.
//
// As in the tissue (yarn.h), a yarn's centre line goes from A to -A between two crossings of
// different kind as A S(cos(pi t)); where both are of one kind it floats, at A or, bowed, further
// outside, so that the gap to what it crosses is nowhere less than in a plain weave. A is the
// half thickness of the other family's yarns and the gap: thick warp crimps a thin weft.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/mesostructures/periodic.h"
#include "acquisition/mesostructures/plane.h"
#include "acquisition/mesostructures/types.h"
#include "acquisition/mesostructures/yarn.h"
#include "btf/error.h"

namespace weft {

namespace {

/// Which yarn is on top at each crossing of a tile.
class Draft {
 public:
  Draft(std::vector<std::string> rows, Imath::V2i repeat)
      : rows_(std::move(rows)), repeat_(repeat) {}

  int warps() const { return static_cast<int>(rows_.front().size()) * repeat_.x; }
  int wefts() const { return static_cast<int>(rows_.size()) * repeat_.y; }
  /// The warp counts from the left, the weft from the lowest y; row 0 of the text is the highest.
  bool warp_over(int warp, int weft) const {
    const std::size_t row = rows_.size() - 1 - static_cast<std::size_t>(weft) % rows_.size();
    return rows_[row][static_cast<std::size_t>(warp) % rows_[row].size()] == '1';
  }

 private:
  std::vector<std::string> rows_;
  Imath::V2i repeat_;
};

/// One family of yarns, its lengths in tiles.
struct Family {
  Imath::V3d axis, side;
  YarnForm form;
  double amplitude;  // of the centre line's way over and under
  double bow;        // of a float's middle, over the amplitude
  std::uint16_t material;
};

std::vector<std::string> split_rows(const std::string& pattern) {
  std::vector<std::string> rows(1);
  for (const char c : pattern) {
    if (c == '/') {
      rows.emplace_back();
    } else if (c != ' ') {
      rows.back() += c;
    }
  }
  return rows;
}

/// What is wrong with a pattern; empty where nothing is.
std::string fault_of(const std::vector<std::string>& rows) {
  const auto mixed = [](const std::string& yarn) {
    return yarn.find('0') != std::string::npos && yarn.find('1') != std::string::npos;
  };
  for (std::size_t j = 0; j < rows.size(); ++j) {
    if (rows[j].size() != rows[0].size()) {
      return fmt::format("row {} has {} crossings, and row 1 has {}", j + 1, rows[j].size(),
                         rows[0].size());
    }
    if (rows[j].find_first_not_of("01") != std::string::npos)
      return fmt::format("row {} is '{}', expected 0 and 1 only", j + 1, rows[j]);
    if (!mixed(rows[j])) return fmt::format("the weft of row {} is not woven in", j + 1);
  }
  for (std::size_t i = 0; i < rows[0].size(); ++i) {
    std::string column;
    for (const std::string& row : rows) column += row[i];
    if (!mixed(column)) return fmt::format("the warp of column {} is not woven in", i + 1);
  }
  return {};
}

Draft read_draft(const Settings& settings) {
  const auto rows = split_rows(settings.text("pattern", "10/01"));
  const std::string fault = fault_of(rows);
  if (!fault.empty()) {
    throw bad_input(settings.where("pattern"), "'pattern': " + fault,
                    "rows from the top, such as 1100/0110/0011/1001; 1 where the warp is over");
  }
  const Vec2 asked = settings.vec2("repeat", Vec2(2, 2));
  const Imath::V2i repeat(static_cast<int>(asked.x), static_cast<int>(asked.y));
  if (Vec2(repeat) != asked || repeat.x < 1 || repeat.y < 1) {
    throw bad_input(settings.where("repeat"),
                    fmt::format("'repeat' is [{}, {}], expected two whole numbers of at least 1",
                                asked.x, asked.y));
  }
  constexpr int most_yarns = 64;
  const Draft draft(rows, repeat);
  if (std::max(draft.warps(), draft.wefts()) > most_yarns) {
    throw bad_input(settings.where(settings.has("repeat") ? "repeat" : "pattern"),
                    fmt::format("'pattern' and 'repeat' make {} warps and {} wefts, expected at "
                                "most {} of each",
                                draft.warps(), draft.wefts(), most_yarns));
  }
  return draft;
}

/// The form of a family's yarns: its own table's keys go before those of [yarn].
YarnForm read_form(const Settings& both, const Settings& own, int count, int sections) {
  const auto table_of = [&](const char* key) -> const Settings& {
    const bool shared = both.has(key);  // asked in any case, so that the key is known
    return own.has(key) || !shared ? own : both;
  };
  YarnForm form{};
  form.spacing = 1.0 / count;
  const double widest = 0.48 * form.spacing;
  form.half_width = table_of("radius").number("radius", 0.46 * form.spacing, 0.01 * widest, widest);
  form.half_thickness =
      form.half_width * (1 - table_of("flattening").number("flattening", 0.5, 0, 0.95));
  form.plies = static_cast<int>(table_of("plies").integer("plies", 0, 0, 12));
  form.ply_depth = table_of("ply_depth").number("ply_depth", 0.35, 0, 0.8);
  if (form.plies == 0) form.ply_depth = 0;
  form.twist = static_cast<int>(table_of("twist").integer("twist", 0, -64, 64));
  form.sections = sections;
  return form;
}

/// Heights, over the cloth's middle plane, of a yarn that is over where `over` says so.
std::vector<double> centre_line(const std::vector<bool>& over, const Family& family, int steps) {
  const int n = static_cast<int>(over.size());
  const auto at = [&](int crossing) { return over[static_cast<std::size_t>((crossing + n) % n)]; };
  std::vector<double> heights;
  for (int k = 0; k < n * steps; ++k) {
    const double place = static_cast<double>(k) / steps - 0.5;
    const int before = static_cast<int>(std::floor(place));
    const bool kind = at(before);
    const double side = kind ? 1 : -1;
    if (at(before + 1) != kind) {
      heights.push_back(side * family.amplitude * crossing_height(place - before));
      continue;
    }
    int first = before;
    int last = before + 1;
    while (at(first + n - 1) == kind && first > before - n) --first;
    while (at(last + 1) == kind && last < before + n) ++last;
    const double arch = std::sin(std::numbers::pi * (place - first) / (last - first));
    heights.push_back(side * (family.amplitude + family.bow * arch * arch));
  }
  return heights;
}

TriangleMesh build_weave(const Settings& settings) {
  const Draft draft = read_draft(settings);
  const auto sections = static_cast<int>(settings.integer("sections", 16, 8, 128));
  const auto steps = static_cast<int>(settings.integer("steps", 8, 8, 128));
  const double gap = settings.number("gap", 0.04, 0.02, 2);
  const double bow = settings.number("bow", 0.2, 0, 2);
  const Settings both = settings.table("yarn");
  Family weft{{1, 0, 0}, {0, -1, 0}, {}, 0, 0, 0};
  Family warp{{0, 1, 0}, {1, 0, 0}, {}, 0, 0, 1};
  weft.form = read_form(both, settings.table("weft"), draft.wefts(), sections);
  warp.form = read_form(both, settings.table("warp"), draft.warps(), sections);
  weft.amplitude = warp.form.half_thickness * (1 + gap);
  warp.amplitude = weft.form.half_thickness * (1 + gap);
  for (Family* family : {&weft, &warp}) family->bow = bow * family->form.half_thickness;
  const double middle =
      weft.amplitude + weft.bow + warp.amplitude + warp.bow + weft.form.half_thickness;

  PolygonMesh cage;
  cage.material_names = {"weft", "warp", "floor"};
  const auto add = [&](const Family& family, const Imath::V3d& begin,
                       const std::vector<bool>& over) {
    YarnPath path{family.axis, family.side, begin + Imath::V3d(0, 0, middle), {}};
    path.heights = centre_line(over, family, steps);
    add_yarn(cage, family.form, path, family.material);
  };
  for (int j = 0; j < draft.wefts(); ++j) {
    std::vector<bool> over;
    for (int i = 0; i < draft.warps(); ++i) over.push_back(!draft.warp_over(i, j));
    add(weft, {0, (j + 0.5) / draft.wefts(), 0}, over);
  }
  for (int i = 0; i < draft.warps(); ++i) {
    std::vector<bool> over;
    for (int j = 0; j < draft.wefts(); ++j) over.push_back(draft.warp_over(i, j));
    add(warp, {(i + 0.5) / draft.warps(), 0, 0}, over);
  }
  const auto levels = static_cast<int>(settings.integer("subdivide", 1, 1, 4));
  TriangleMesh mesh = triangulate(periodic_limit_surface(cage, levels));
  add_plane(mesh, 0, 2);
  return mesh;
}

}  // namespace

MesostructureType weave_type() {
  return {"weave",
          "woven cloth from a weave pattern over a floor, as subdivision surfaces",
          "pattern = '10/01'   rows of crossings from the top, 1 where the warp (along y) is over\n"
          "repeat = [2, 2]     of the pattern in a tile, along x and along y\n"
          "yarn.radius         half the width of warp and weft, in tiles; 0.46 of the spacing, at "
          "most 0.48\n"
          "yarn.flattening = 0.5   1 - thickness / width\n"
          "yarn.plies = 0      strands twisted into a yarn; 0: a smooth yarn\n"
          "yarn.ply_depth = 0.35   of the grooves between plies, in yarn radii\n"
          "yarn.twist = 0      turns of the plies in a tile\n"
          "warp.*, weft.*      each key of yarn for one family alone\n"
          "gap = 0.04          between crossing yarns, in thicknesses of the yarn crossed\n"
          "bow = 0.2           of a float's middle beyond its ends, in half thicknesses\n"
          "sections = 16       control points around a yarn\n"
          "steps = 8           control rings from one crossing to the next\n"
          "subdivide = 1       levels of Catmull-Clark subdivision, then the limit surface",
          build_weave,
          {{"weft", "type = 'plastic'\nalbedo = [0.6, 0.55, 0.48]\nior = 1.5\nalpha = 0.4"},
           {"warp", "type = 'plastic'\nalbedo = [0.6, 0.55, 0.48]\nior = 1.5\nalpha = 0.4"},
           {"floor", "type = 'lambert'\nalbedo = [0.1, 0.08, 0.07]"}}};
}

}  // namespace weft
