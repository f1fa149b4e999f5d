// Knitted wool: a plain (stockinette) knit of plied yarns, down to single fibres.
//
// The centre line of a course is the simplest curve of loops that interlock: x = t + a
// sin(2t), y = h cos(t), z = -d cos(2t), with a = 3/2 of 2 pi a stitch; h is 0.85 of the distance
// of the courses, so that each loop passes through the one below, its legs in front. The depth d is
// the least at which yarns of the asked radius do not meet.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "acquisition/mesostructures/plane.h"
#include "acquisition/mesostructures/types.h"
#include "btf/error.h"
#include "btf/random.h"

namespace weft {

namespace {

using Vec3d = Imath::V3d;
constexpr double pi = std::numbers::pi;

/// One stitch of a course, its lengths in tiles.
struct Loop {
  double width;
  double height;  // from course to course
  double depth = 0;

  /// The centre line after `s` stitches; the course's middle is at y = 0, z = 0.
  Vec3d at(double s) const {
    constexpr double swing = 1.5 / (2 * pi);
    constexpr double rise = 0.85;
    return {width * (s + swing * std::sin(4 * pi * s)), height * rise * std::cos(2 * pi * s),
            -depth * std::cos(4 * pi * s)};
  }
};

/// Least distance of the centre lines of two yarns, or of two places of a yarn that are no
/// neighbours.
double clearance(const Loop& loop, double radius) {
  constexpr int n = 128;  // points a stitch
  std::array<Vec3d, 3 * n> points;
  std::array<double, 3 * n> length{};
  for (int i = 0; i < 3 * n; ++i) {
    points[i] = loop.at(static_cast<double>(i) / n - 1);
    if (i > 0) length[i] = length[i - 1] + (points[i] - points[i - 1]).length();
  }
  double least = 1e9;
  for (int i = n; i <= n + n / 2; ++i) {  // a stitch is symmetric
    for (int j = 0; j < 3 * n; ++j) {
      const bool neighbours = std::abs(length[i] - length[j]) < 1.2 * pi * radius;
      for (int course = neighbours ? 1 : 0; course <= 2; ++course) {
        for (const int side : {-1, 1}) {
          const Vec3d d = points[i] - points[j] + Vec3d(0, side * course * loop.height, 0);
          least = std::min(least, d.length2());
        }
      }
    }
  }
  return std::sqrt(least);
}

/// The shallowest loop in which yarns of a radius do not meet; none where they do in any.
std::optional<Loop> loop_for(double width, double height, double radius) {
  for (double depth = 1; depth < 3; depth += 0.05) {
    const Loop loop{width, height, depth * radius};
    if (clearance(loop, radius) >= 2 * radius) return loop;
  }
  return std::nullopt;
}

double largest_radius(double width, double height) {
  double low = 0;
  double high = width;
  for (int round = 0; round < 10; ++round) {
    const double middle = (low + high) / 2;
    (loop_for(width, height, middle) ? low : high) = middle;
  }
  return low;
}

/// Lengths in tiles.
struct Yarn {
  double radius;
  int plies;
  int fibres;  // a ply
  int twist;   // turns of the plies a stitch
  double fibre_radius;
  double wander;  // of fibres within their ply, in its radii
  double ply_radius() const {
    const double s = std::sin(pi / plies);
    return plies == 1 ? radius : radius * s / (1 + s);
  }
};

struct Knit {
  int wales;  // stitches a course
  int courses;
  Yarn yarn;
  int stray;  // fibres a stitch
  int steps;  // segments of a fibre a stitch
  std::uint64_t seed;
  Loop loop;
};

/// Numbers in [0, 1) that belong to one fibre.
class FibreNumbers {
 public:
  FibreNumbers(std::uint64_t seed, int kind, int course, int fibre)
      : key_(hash_coordinates(seed, kind, course, fibre)) {}
  double operator()(int dimension) const { return unit_float(hash_coordinates(key_, dimension)); }

 private:
  std::uint64_t key_;
};

/// The centre line by its length, and directions across it. Each stitch is the next one's equal.
class CentreLine {
 public:
  explicit CentreLine(const Loop& loop) : loop_(loop) {
    for (int i = 1; i <= samples; ++i) {
      lengths_[i] = lengths_[i - 1] + (loop.at(static_cast<double>(i) / samples) -
                                       loop.at(static_cast<double>(i - 1) / samples))
                                          .length();
    }
  }

  struct Place {
    Vec3d centre, front, beside;
  };
  /// @param t  length from the course's begin, in stitches.
  Place at(double t) const {
    const double whole = std::floor(t);
    const double target = (t - whole) * lengths_[samples];
    const auto next = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, target);
    const double part = (target - *(next - 1)) / (*next - *(next - 1));
    const double s = whole + (static_cast<double>(next - 1 - lengths_.begin()) + part) / samples;
    const Vec3d along = (loop_.at(s + 1e-5) - loop_.at(s - 1e-5)).normalized();
    // A loop is nowhere upright.
    const Vec3d front = (Vec3d(0, 0, 1) - along * along.z).normalized();
    return {loop_.at(s), front, along.cross(front)};
  }

 private:
  static constexpr int samples = 512;
  Loop loop_;
  std::array<double, samples + 1> lengths_{};
};

using Strand = std::vector<CurveSet::Control>;

/// Controls of the B-spline that passes, nearly, through the points: its limit points are (1, 4, 1)
/// / 6 of their neighbours.
Strand controls_through(const std::vector<Vec3d>& points) {
  Strand strand;
  for (std::size_t k = 1; k + 1 < points.size(); ++k) {
    const Vec3d bend = (points[k - 1] - 2.0 * points[k] + points[k + 1]) / 6;
    strand.push_back({Vec3(points[k] - bend), 0});
  }
  return strand;
}

/// A fibre along a whole course; its end is its begin in the next tile.
Strand fibre_of(const Knit& knit, const CentreLine& line, int course, int ply, int fibre) {
  const Yarn& yarn = knit.yarn;
  const double ply_radius = yarn.ply_radius();
  const double room = std::max(0.0, ply_radius - yarn.fibre_radius);
  const FibreNumbers random(knit.seed, 0, course, ply * yarn.fibres + fibre);
  constexpr double golden_angle = 2.399963;
  const double rest = room * std::sqrt(fibre / (yarn.fibres - 0.5));
  const auto wave = [&](double t, int first) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const double turns = 1 + std::floor(2 * knit.wales * random(first + 2 * k));
      sum += std::sin(2 * pi * (turns * t / knit.wales + random(first + 2 * k + 1))) / 3;
    }
    return sum;
  };
  const auto point = [&](double t) {
    const CentreLine::Place place = line.at(t);
    const double turn = 2 * pi * (yarn.twist * t + static_cast<double>(ply) / yarn.plies);
    // Plies are spun the other way round than they are twisted into a yarn.
    const double spin =
        golden_angle * fibre + (yarn.plies == 1 ? 2 : -2) * pi * yarn.twist * t + 2 * pi * ply / 7;
    Imath::V2d within(rest * std::cos(spin) + yarn.wander * ply_radius * wave(t, 0),
                      rest * std::sin(spin) + yarn.wander * ply_radius * wave(t, 6));
    if (within.length() > room) within *= room / within.length();
    const double aside = yarn.radius - ply_radius;
    return place.centre + place.front * (aside * std::cos(turn) + within.x) +
           place.beside * (aside * std::sin(turn) + within.y);
  };
  std::vector<Vec3d> points;
  for (int k = -2; k <= knit.wales * knit.steps + 2; ++k)
    points.push_back(point(static_cast<double>(k) / knit.steps));
  Strand strand = controls_through(points);
  for (CurveSet::Control& control : strand) control.radius = static_cast<float>(yarn.fibre_radius);
  return strand;
}

/// A fibre that leaves the yarn and ends, thinner and thinner.
Strand stray_fibre(const Knit& knit, const CentreLine& line, int course, int fibre) {
  constexpr int points = 16;
  const Yarn& yarn = knit.yarn;
  const FibreNumbers random(knit.seed, 1, course, fibre);
  const double begin = knit.wales * random(0);
  const double length = (random(1) < 0.5 ? -1 : 1) * (0.1 + 0.25 * random(2));
  const double angle = 2 * pi * random(3);
  const double turn = 3 * (random(4) - 0.5);
  const double reach = 0.5 + 1.2 * random(5);
  std::vector<Vec3d> path;
  for (int k = 0; k < points + 2; ++k) {
    const double part = static_cast<double>(k) / points;
    const CentreLine::Place place = line.at(begin + length * part);
    const double away = yarn.radius * (0.6 + reach * part * part +
                                       0.1 * std::sin(2 * pi * (random(6) + 1.5 * part)));
    const double at = angle + turn * part;
    path.push_back(place.centre + place.front * (away * std::cos(at)) +
                   place.beside * (away * std::sin(at)));
  }
  Strand strand = controls_through(path);
  for (std::size_t k = 3; k + 3 < strand.size(); ++k)
    strand[k].radius = static_cast<float>(yarn.fibre_radius);
  return strand;
}

Imath::V2i read_stitches(const Settings& settings) {
  const Vec2 asked = settings.vec2("stitches", Vec2(3, 5));
  const Imath::V2i stitches(static_cast<int>(asked.x), static_cast<int>(asked.y));
  if (Vec2(stitches) != asked || std::min(stitches.x, stitches.y) < 1 ||
      std::max(stitches.x, stitches.y) > 64) {
    throw bad_input(settings.where("stitches"),
                    fmt::format("'stitches' is [{}, {}], expected two whole numbers from 1 to 64",
                                asked.x, asked.y));
  }
  return stitches;
}

Knit read_knit(const Settings& settings) {
  Knit knit{};
  const Imath::V2i stitches = read_stitches(settings);
  knit.wales = stitches.x;
  knit.courses = stitches.y;
  knit.stray = static_cast<int>(settings.integer("stray", 12, 0, 1000));
  knit.steps = static_cast<int>(settings.integer("steps", 20, 12, 256));
  knit.seed = static_cast<std::uint64_t>(settings.integer("seed", 0, 0, 1'000'000'000));
  const Settings table = settings.table("yarn");
  Yarn& yarn = knit.yarn;
  const double width = 1.0 / knit.wales;
  const double height = 1.0 / knit.courses;
  yarn.radius = table.number("radius", 0.12 * width, 0.01 * width, width);
  const std::optional<Loop> loop = loop_for(width, height, yarn.radius);
  if (!loop) {
    throw bad_input(
        table.where("radius"),
        fmt::format("'yarn.radius' is {:.4g}: loops of {} x {} stitches a tile leave "
                    "room for at most {:.4g}",
                    yarn.radius, knit.wales, knit.courses, largest_radius(width, height)));
  }
  knit.loop = *loop;
  yarn.plies = static_cast<int>(table.integer("plies", 3, 1, 12));
  yarn.fibres = static_cast<int>(table.integer("fibres", 20, 1, 1000));
  yarn.twist = static_cast<int>(table.integer("twist", 2, -knit.steps / 6, knit.steps / 6));
  const Settings fibre = settings.table("fibre");
  const double ply = yarn.ply_radius();
  yarn.fibre_radius = fibre.number("radius", 0.75 * ply / std::sqrt(yarn.fibres), 0.001 * ply, ply);
  yarn.wander = fibre.number("wander", 0.25, 0, 1);
  constexpr std::int64_t most_segments = 250'000;
  const std::int64_t strands = static_cast<std::int64_t>(yarn.plies) * yarn.fibres;
  const std::int64_t segments =
      knit.wales * knit.courses * (strands * knit.steps + knit.stray * 13);
  if (segments > most_segments) {
    throw bad_input(table.where(table.has("fibres") ? "fibres" : ""),
                    fmt::format("{} fibres a yarn make {} segments of curves, expected at most {}",
                                strands, segments, most_segments),
                    "fewer 'yarn.fibres', 'stitches', 'steps' or 'stray'");
  }
  return knit;
}

TileGeometry build_knit(const Settings& settings) {
  const Knit knit = read_knit(settings);
  const CentreLine line(knit.loop);
  CurveSet curves;
  const auto add = [&](Strand strand, int course) {
    for (CurveSet::Control& control : strand)
      control.position.y += static_cast<float>((course + 0.5) / knit.courses);
    curves.add_strand(strand, 0);
  };
  for (int course = 0; course < knit.courses; ++course) {
    for (int ply = 0; ply < knit.yarn.plies; ++ply) {
      for (int fibre = 0; fibre < knit.yarn.fibres; ++fibre)
        add(fibre_of(knit, line, course, ply, fibre), course);
    }
    for (int fibre = 0; fibre < knit.stray * knit.wales; ++fibre)
      add(stray_fibre(knit, line, course, fibre), course);
  }
  // Nearly on the floor.
  const float lift = 0.1F * static_cast<float>(knit.yarn.radius) - bounds_of(curves).low.z;
  for (CurveSet::Control& control : curves.controls) control.position.z += lift;
  TriangleMesh mesh;
  mesh.material_names = {"yarn", "floor"};
  add_plane(mesh, 0, 1);
  return {mesh, curves};
}

}  // namespace

MesostructureType knit_type() {
  return {"knit",
          "plain knit of plied wool over a floor, every fibre a curve",
          "stitches = [3, 5]   in a tile, along x and along y\n"
          "yarn.radius         in tiles; 0.12 of a stitch's width, at most about 0.13\n"
          "yarn.plies = 3      strands twisted into a yarn\n"
          "yarn.fibres = 20    in a ply\n"
          "yarn.twist = 2      turns of the plies in a stitch\n"
          "fibre.radius        in tiles; 0.75 of a ply's radius over the root of its fibres\n"
          "fibre.wander = 0.25 how far fibres stray within their ply, in its radii\n"
          "stray = 12          fibres in a stitch that stick out of the yarn\n"
          "steps = 20          segments of a fibre in a stitch, at least 6 a turn\n"
          "seed = 0            of what is random",
          build_knit,
          {{"yarn", "type = 'plastic'\nalbedo = [0.8, 0.76, 0.68]\nior = 1.5\nalpha = 0.4"},
           {"floor", "type = 'lambert'\nalbedo = [0.1, 0.08, 0.07]"}}};
}

}  // namespace weft
