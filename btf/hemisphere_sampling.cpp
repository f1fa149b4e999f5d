#include "btf/hemisphere_sampling.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "btf/delaunay.h"
#include "btf/error.h"

namespace weft {

namespace {

constexpr std::size_t max_directions = 16000;
constexpr float distinct_angle = 1e-4F;  // rad

std::string angles(const Direction& d) {
  return fmt::format("(theta {:.4f}, phi {:.4f} degrees)", degrees(theta_of(d)),
                     degrees(phi_of(d)));
}

void check(const std::vector<Direction>& directions) {
  if (directions.empty() || directions.size() > max_directions) {
    throw bad_input("directions", fmt::format("{} directions; expected 1 to {}", directions.size(),
                                              max_directions));
  }
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Direction& d = directions[i];
    if (!(std::abs(d.length() - 1) < 1e-4F) || !(d.z >= 0)) {
      throw bad_input("directions",
                      fmt::format("direction {} is ({}, {}, {}); expected a unit vector with "
                                  "z >= 0",
                                  i, d.x, d.y, d.z));
    }
    for (std::size_t j = 0; j < i; ++j) {
      if ((d - directions[j]).length() < distinct_angle) {
        throw bad_input("directions",
                        fmt::format("direction {} {} repeats direction {}", i, angles(d), j));
      }
    }
  }
}

// Bonn's reader joins the lowest ring with a ring outside the disc whose values are zero: as many
// points as the ring has (at least 10), far enough out that its polygon covers the disc.
std::vector<Vec2> ring_below_horizon(const std::vector<Direction>& directions) {
  const auto lower = [](const Direction& a, const Direction& b) { return a.z < b.z; };
  const float lowest = std::min_element(directions.begin(), directions.end(), lower)->z;
  if (lowest <= 0) return {};
  const auto in_ring = std::count_if(directions.begin(), directions.end(),
                                     [&](const Direction& d) { return d.z < lowest + 1e-3F; });
  const int n = std::max(10, static_cast<int>(in_ring));
  const double radius = 1 / std::cos(std::numbers::pi / n);
  std::vector<Vec2> ring;
  for (int i = 0; i < n; ++i) {
    const double phi = 2 * std::numbers::pi * i / n;
    ring.emplace_back(static_cast<float>(radius * std::cos(phi)),
                      static_cast<float>(radius * std::sin(phi)));
  }
  return ring;
}

// In double: slivers at the hull have areas that float products would drown.
double cross(const Vec2& a, const Vec2& b) {
  return static_cast<double>(a.x) * b.y - static_cast<double>(a.y) * b.x;
}

}  // namespace

HemisphereSampling::HemisphereSampling(std::vector<Direction> directions, Horizon horizon)
    : directions_(std::move(directions)), horizon_(horizon) {
  check(directions_);
  prepare();
  triangles_ = delaunay_triangles(tables_.points);
  fill_grid();
}

HemisphereSampling::HemisphereSampling(std::vector<Direction> directions,
                                       std::vector<std::array<std::uint16_t, 3>> triangles,
                                       Horizon horizon)
    : directions_(std::move(directions)), triangles_(std::move(triangles)), horizon_(horizon) {
  check(directions_);
  prepare();
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const auto& [a, b, c] = triangles_[t];
    const std::size_t n = tables_.points.size();
    if (a >= n || b >= n || c >= n) {
      throw bad_input("triangles",
                      fmt::format("triangle {} names a direction that is not there", t));
    }
    const Vec2 p = tables_.points[a];
    if (!(cross(tables_.points[b] - p, tables_.points[c] - p) > 0)) {
      throw bad_input("triangles", fmt::format("triangle {} is not counter-clockwise", t));
    }
  }
  fill_grid();
}

void HemisphereSampling::prepare() {
  for (const Direction& d : directions_) tables_.points.push_back(parabolic(d));
  if (horizon_ == Horizon::fade) {
    const std::vector<Vec2> ring = ring_below_horizon(directions_);
    tables_.points.insert(tables_.points.end(), ring.begin(), ring.end());
  }
}

void HemisphereSampling::fill_grid() {
  if (triangles_.empty()) return;
  if (triangles_.size() >= Tables::hull_flag) {
    throw bad_input("triangles", fmt::format("{} triangles; expected at most {}", triangles_.size(),
                                             Tables::hull_flag - 1));
  }
  std::map<std::pair<std::uint16_t, std::uint16_t>, std::uint16_t> triangle_left_of;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto edge = std::pair(triangles_[t][i], triangles_[t][(i + 1) % 3]);
      if (!triangle_left_of.emplace(edge, static_cast<std::uint16_t>(t)).second) {
        throw bad_input("triangles", fmt::format("two triangles share the directed edge {} - {}",
                                                 edge.first, edge.second));
      }
    }
  }
  std::map<std::uint16_t, std::uint16_t> after_on_hull;
  for (const auto& [edge, triangle] : triangle_left_of) {
    if (triangle_left_of.contains({edge.second, edge.first})) continue;
    if (!after_on_hull.emplace(edge).second) {
      throw bad_input("triangles",
                      fmt::format("their outline passes direction {} more than once", edge.first));
    }
  }
  std::map<std::uint16_t, std::uint16_t> hull_position;
  std::uint16_t point = after_on_hull.begin()->first;
  while (!hull_position.contains(point)) {
    hull_position[point] = static_cast<std::uint16_t>(tables_.hull.size());
    tables_.hull.push_back(point);
    const auto next = after_on_hull.find(point);
    if (next == after_on_hull.end()) throw bad_input("triangles", "their outline is not closed");
    point = next->second;
  }
  if (tables_.hull.size() != after_on_hull.size()) {
    throw bad_input("triangles", "their outline is not one polygon");
  }
  for (const auto& t : triangles_) {
    std::array<std::uint16_t, 6> row{t[0], t[1], t[2], 0, 0, 0};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint16_t a = t[(i + 1) % 3];
      const std::uint16_t b = t[(i + 2) % 3];
      const auto across = triangle_left_of.find({b, a});
      row[3 + i] = across != triangle_left_of.end()
                       ? across->second
                       : static_cast<std::uint16_t>(Tables::hull_flag | hull_position.at(a));
    }
    tables_.triangles.push_back(row);
  }
  tables_.grid.resize(static_cast<std::size_t>(grid_size) * grid_size);
  std::uint16_t triangle = 0;
  for (int y = 0; y < grid_size; ++y) {
    for (int i = 0; i < grid_size; ++i) {
      const int x =
          y % 2 == 0 ? i : grid_size - 1 - i;  // to and fro: each walk starts next to its end
      const Vec2 p(2 * (static_cast<float>(x) + 0.5F) / grid_size - 1,
                   2 * (static_cast<float>(y) + 0.5F) / grid_size - 1);
      std::array<float, 3> weight;
      const std::uint16_t end = walk(triangle, p, weight);
      if ((end & Tables::hull_flag) == 0)
        triangle = end;
      else {
        const std::size_t k = end & ~Tables::hull_flag;
        triangle =
            triangle_left_of.at({tables_.hull[k], tables_.hull[(k + 1) % tables_.hull.size()]});
      }
      tables_.grid[static_cast<std::size_t>(y) * grid_size + x] = triangle;
    }
  }
}

// Walks from `triangle` to the one that holds p, or to an edge of the hull that p is beyond. A
// visibility walk in a Delaunay triangulation ends; the bound is for triangulations that a file
// brings.
std::uint16_t HemisphereSampling::walk(std::uint16_t triangle, const Vec2& p,
                                       std::array<float, 3>& weight) const {
  weight = {1, 0, 0};  // where the bound ends the walk
  for (std::size_t step = 0; step <= tables_.triangles.size(); ++step) {
    const auto& t = tables_.triangles[triangle];
    const Vec2& a = tables_.points[t[0]];
    const Vec2& b = tables_.points[t[1]];
    const Vec2& c = tables_.points[t[2]];
    const double area = cross(b - a, c - a);
    const std::array<double, 3> part{cross(c - b, p - b), cross(a - c, p - c), cross(b - a, p - a)};
    // Across the edge that p is furthest beyond; over the hull only where no other edge leads on.
    std::size_t side = 3;
    for (std::size_t i = 0; i < 3; ++i) {
      if (part[i] >= 0) continue;
      const auto rank = [&](std::size_t k) {
        return std::pair((t[3 + k] & Tables::hull_flag) != 0, part[k]);
      };
      if (side == 3 || rank(i) < rank(side)) side = i;
    }
    if (side == 3) {
      for (std::size_t i = 0; i < 3; ++i) weight[i] = static_cast<float>(part[i] / area);
      return triangle;
    }
    triangle = t[3 + side];
    if ((triangle & Tables::hull_flag) != 0) return triangle;
  }
  return triangle;
}

// The nearest point of the hull: slide from edge to edge while the foot of the perpendicular lies
// beyond an end.
Stencil HemisphereSampling::hold(std::size_t edge, const Vec2& p) const {
  const std::size_t n = tables_.hull.size();
  int last_turn = 0;
  for (std::size_t step = 0; step < n; ++step) {
    const std::uint16_t a = tables_.hull[edge];
    const std::uint16_t b = tables_.hull[(edge + 1) % n];
    const Vec2 along = tables_.points[b] - tables_.points[a];
    const float s = ((p - tables_.points[a]) ^ along) / along.length2();
    const int turn = s < 0 ? -1 : s > 1 ? 1 : 0;
    if (turn == 0 || turn == -last_turn) {
      const float w = std::clamp(s, 0.0F, 1.0F);
      return {{a, b, a}, {1 - w, w, 0}};
    }
    last_turn = turn;
    edge = turn < 0 ? (edge + n - 1) % n : (edge + 1) % n;
  }
  const std::uint16_t a = tables_.hull[edge];
  return {{a, a, a}, {1, 0, 0}};
}

std::uint16_t HemisphereSampling::nearest(const Direction& direction) const {
  std::size_t best = 0;
  float largest = -2;
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    const float cosine = directions_[i] ^ direction;
    if (cosine > largest) {
      largest = cosine;
      best = i;
    }
  }
  return static_cast<std::uint16_t>(best);
}

Stencil HemisphereSampling::nearest_stencil(const Direction& direction) const {
  const std::uint16_t i = nearest(direction);
  return {{i, i, i}, {1, 0, 0}};
}

Stencil HemisphereSampling::locate(const Direction& direction) const {
  if (tables_.triangles.empty()) return nearest_stencil(direction);
  const Vec2 p = parabolic(direction);
  const auto cell = [](float coordinate) {
    const float place = (coordinate + 1) * (grid_size / 2.0F);
    // Compared before it is cast: no cast of a NaN is defined.
    return place > 0 ? static_cast<int>(std::min<float>(place, grid_size - 1)) : 0;
  };
  std::array<float, 3> weight;
  const std::uint16_t start =
      tables_.grid[static_cast<std::size_t>(cell(p.y)) * grid_size + cell(p.x)];
  const std::uint16_t end = walk(start, p, weight);
  Stencil stencil;
  if ((end & Tables::hull_flag) != 0) {
    stencil = hold(end & ~Tables::hull_flag, p);
  } else {
    const auto& t = tables_.triangles[end];
    stencil = {{t[0], t[1], t[2]}, weight};
  }
  if (horizon_ == Horizon::fade) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (stencil.index[i] >= directions_.size()) {
        stencil.index[i] = 0;
        stencil.weight[i] = 0;
      }
    }
  }
  return stencil;
}

}  // namespace weft
