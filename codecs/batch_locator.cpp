#include "codecs/batch_locator.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "codecs/wide_vector.h"

namespace weft {

namespace {

using UShort4 = std::uint16_t __attribute__((vector_size(8)));

// Bounds that rounding may bring below 0: of a point on the border of two faces either answers.
constexpr float slack = 2e-6F;
constexpr int most_steps = 16;
constexpr std::uint16_t no_face = 0xFFFF;

// c + x p.x + y p.y.
struct Affine {
  double c;
  double x;
  double y;

  Affine operator*(double s) const { return {c * s, x * s, y * s}; }
  double at(const Vec2& p) const { return c + x * p.x + y * p.y; }
};

// Twice the signed area of p, q, r, of r.
Affine side(const Vec2& p, const Vec2& q) {
  const double dx = static_cast<double>(q.x) - p.x;
  const double dy = static_cast<double>(q.y) - p.y;
  return {dy * p.x - dx * p.y, -dy, dx};
}

// 0 at p, 1 at q.
Affine along(const Vec2& p, const Vec2& q) {
  const double dx = static_cast<double>(q.x) - p.x;
  const double dy = static_cast<double>(q.y) - p.y;
  return Affine{-dx * p.x - dy * p.y, dx, dy} * (1 / (dx * dx + dy * dy));
}

Affine one_minus(const Affine& a) {
  return {1 - a.c, -a.x, -a.y};
}

template <typename Bounds>
void set_bounds(Bounds& bound, const std::array<Affine, 3>& of_corner) {
  for (std::size_t i = 0; i < 3; ++i) {
    bound[0][i] = static_cast<float>(of_corner[i].c);
    bound[1][i] = static_cast<float>(of_corner[i].x);
    bound[2][i] = static_cast<float>(of_corner[i].y);
  }
}

bool is_convex(const HemisphereSampling::Tables& tables) {
  const std::size_t n = tables.hull.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2& a = tables.points[tables.hull[k]];
    const Vec2& b = tables.points[tables.hull[(k + 1) % n]];
    const Vec2& c = tables.points[tables.hull[(k + 2) % n]];
    if (side(a, b).at(c) < -1e-6 * (b - a).length() * (c - b).length()) return false;
  }
  return true;
}

// c + x p.x + y p.y of the three corners.
inline Vec4 bounds_at(const std::array<std::array<float, 4>, 3>& bound, float x, float y) {
  return load<Vec4>(bound[0].data()) + load<Vec4>(bound[1].data()) * x +
         load<Vec4>(bound[2].data()) * y;
}

inline bool is_beyond(const Vec4& bound) {
  const Int4 below = bound < Vec4{} - slack;
  std::array<std::uint64_t, 2> bits;
  std::memcpy(&bits, &below, sizeof bits);
  return (bits[0] | bits[1]) != 0;
}

// Cell of a coordinate of the parabolic square; a NaN's is 0.
std::int32_t cell_of(float p) {
  constexpr int size = HemisphereSampling::grid_size;
  const float q = (p + 1) * (size / 2.0F);
  return q > 0 ? static_cast<std::int32_t>(std::min(q, size - 1.0F)) : 0;
}

}  // namespace

StencilLane lane_of(const Stencil& stencil) {
  StencilLane lane{};
  for (std::size_t i = 0; i < 3; ++i) {
    lane.index[i] = stencil.index[i];
    lane.weight[i] = stencil.weight[i];
  }
  return lane;
}

BatchLocator::Face BatchLocator::triangle_face(const HemisphereSampling& sampling,
                                               std::size_t triangle) {
  const HemisphereSampling::Tables& tables = sampling.tables();
  const auto& t = tables.triangles[triangle];
  Face face;
  std::array<Affine, 3> bounds;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2& corner = tables.points[t[i]];
    const Affine opposite = side(tables.points[t[(i + 1) % 3]], tables.points[t[(i + 2) % 3]]);
    bounds[i] = opposite * (1 / opposite.at(corner));
    // Points of the ring below the horizon hold zero.
    const bool is_sampled = t[i] < sampling.size();
    face.corner[i] = is_sampled ? t[i] : 0;
    face.most[i] = is_sampled ? 1 : 0;
    constexpr std::uint16_t flag = HemisphereSampling::Tables::hull_flag;
    face.beyond[i] = (t[3 + i] & flag) == 0
                         ? t[3 + i]
                         : static_cast<std::uint16_t>(tables.triangles.size() + (t[3 + i] & ~flag));
  }
  set_bounds(face.bound, bounds);
  return face;
}

// The strip beyond each edge of the hull, then the wedge beyond each corner.
void BatchLocator::append_hull_faces(const HemisphereSampling& sampling) {
  const HemisphereSampling::Tables& tables = sampling.tables();
  const std::size_t n = tables.hull.size();
  const std::size_t first_strip = tables.triangles.size();
  const auto strip = [&](std::size_t k) { return static_cast<std::uint16_t>(first_strip + k % n); };
  const auto wedge = [&](std::size_t k) {
    return static_cast<std::uint16_t>(first_strip + n + k % n);
  };
  const auto edge = [&](std::size_t k) {
    return std::pair(tables.points[tables.hull[k % n]], tables.points[tables.hull[(k + 1) % n]]);
  };
  const auto index = [&](std::size_t k) { return tables.hull[k % n]; };
  const auto most = [&](std::size_t k) { return index(k) < sampling.size() ? 1.0F : 0.0F; };
  const auto corner = [&](std::size_t k) {
    return static_cast<std::uint16_t>(most(k) > 0 ? index(k) : 0);
  };
  for (std::size_t k = 0; k < n; ++k) {
    const auto [a, b] = edge(k);
    const Affine s = along(a, b);
    Face face;
    set_bounds(face.bound,
               {one_minus(s), s, side(b, a) * (1 / static_cast<double>((b - a).length2()))});
    face.most = {most(k), most(k + 1), 0};
    face.corner = {corner(k), corner(k + 1), 0};
    face.beyond = {wedge(k + 1), wedge(k), 0};
    faces_.push_back(face);
  }
  for (std::size_t k = 0; k < n; ++k) {
    const auto [a, b] = edge(k + n - 1);
    const auto [c, d] = edge(k);
    Face face;
    set_bounds(face.bound, {Affine{1, 0, 0}, one_minus(along(a, b)) * -1, along(c, d) * -1});
    face.most = {most(k), 0, 0};
    face.corner = {corner(k), 0, 0};
    face.beyond = {0, strip(k + n - 1), strip(k)};
    faces_.push_back(face);
  }
  for (std::size_t t = 0; t < first_strip; ++t) {
    for (const std::uint16_t beyond : faces_[t].beyond)
      if (beyond >= first_strip) faces_[beyond].beyond[2] = static_cast<std::uint16_t>(t);
  }
}

BatchLocator::BatchLocator(const HemisphereSampling& sampling) {
  const HemisphereSampling::Tables& tables = sampling.tables();
  if (tables.triangles.empty() || !is_convex(tables)) return;
  for (std::size_t t = 0; t < tables.triangles.size(); ++t)
    faces_.push_back(triangle_face(sampling, t));
  append_hull_faces(sampling);
  constexpr int size = HemisphereSampling::grid_size;
  grid_.resize(tables.grid.size());
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    const auto centre = [](std::size_t cell) {
      return 2 * (static_cast<float>(cell) + 0.5F) / size - 1;
    };
    grid_[i] = face_of(tables.grid[i], centre(i % size), centre(i / size));
  }
}

// Walks from `start`; `no_face` where that takes too long.
std::uint16_t BatchLocator::face_of(std::uint16_t start, float x, float y) const {
  std::uint16_t face = start;
  for (int step = 0; step < most_steps; ++step) {
    const Vec4 bound = bounds_at(faces_[face].bound, x, y);
    std::size_t least = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (bound[i] < bound[least]) least = i;
    if (!(bound[least] < -slack)) return face;
    face = faces_[face].beyond[least];
  }
  return no_face;
}

StencilBatch BatchLocator::locate(const HemisphereSampling& sampling,
                                  const DirectionLanes& directions) const {
  StencilBatch batch;
  alignas(64) Batch<float> x;
  alignas(64) Batch<float> y;
  alignas(64) Batch<std::int32_t> cell;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    x[i] = directions.x[i] / (1 + directions.z[i]);
    y[i] = directions.y[i] / (1 + directions.z[i]);
    cell[i] = cell_of(y[i]) * HemisphereSampling::grid_size + cell_of(x[i]);
  }
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    std::uint16_t face = grid_.empty() ? no_face : grid_[cell[i]];
    if (face != no_face && is_beyond(bounds_at(faces_[face].bound, x[i], y[i])))
      face = face_of(face, x[i], y[i]);
    if (face == no_face) {
      batch[i] = lane_of(sampling.locate({directions.x[i], directions.y[i], directions.z[i]}));
      continue;
    }
    const Face& f = faces_[face];
    const Vec4 bound = bounds_at(f.bound, x[i], y[i]);
    const Vec4 zero{};
    const Vec4 most = load<Vec4>(f.most.data());
    const Vec4 not_negative = bound < zero ? zero : bound;  // a NaN stays one
    const Vec4 weight = not_negative > most ? most : not_negative;
    UShort4 corner;
    std::memcpy(&corner, f.corner.data(), sizeof corner);
    const Int4 index = __builtin_convertvector(corner, Int4);
    std::memcpy(batch[i].index.data(), &index, sizeof index);
    std::memcpy(batch[i].weight.data(), &weight, sizeof weight);
  }
  return batch;
}

}  // namespace weft
