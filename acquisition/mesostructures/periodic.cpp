#include "acquisition/mesostructures/periodic.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "tracer/subdivision.h"

namespace weft {

namespace {

using Vec3d = Imath::V3d;

constexpr double same_point = 1e-5;

/// Each vertex as a point of the periodic plane, and the tile that it lies in.
struct PeriodicPoints {
  struct Vertex {
    std::uint32_t point;
    int tile_x, tile_y;
  };
  std::vector<Vertex> vertices;
  std::vector<Vec3d> points;
};

/// Finds points near a place through a grid of cells of twice `same_point`, which wraps at the
/// tile's border.
class PointGrid {
 public:
  /// The point within `same_point` of `p` (x and y modulo 1), or `fresh`, which is then at `p`.
  std::uint32_t find_or_add(const Vec3d& p, std::uint32_t fresh, const std::vector<Vec3d>& points) {
    const auto cell_of = [](double v) { return static_cast<std::int64_t>(std::floor(v * cells)); };
    const std::int64_t cx = cell_of(p.x);
    const std::int64_t cy = cell_of(p.y);
    const std::int64_t cz = cell_of(p.z);
    for (std::int64_t i = 0; i < 27; ++i) {
      const auto found = cells_.find(key(cx + i % 3 - 1, cy + i / 3 % 3 - 1, cz + i / 9 - 1));
      if (found == cells_.end()) continue;
      for (const std::uint32_t candidate : found->second) {
        if (distance(points[candidate], p) < same_point) return candidate;
      }
    }
    cells_[key(cx, cy, cz)].push_back(fresh);
    return fresh;
  }

 private:
  static constexpr std::int64_t cells = 50000;

  static std::int64_t wrapped(std::int64_t cell) { return (cell % cells + cells) % cells; }
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    const auto plane = static_cast<std::uint64_t>(wrapped(x) * cells + wrapped(y));
    return plane * 0x9E3779B97F4A7C15ULL + static_cast<std::uint64_t>(z);
  }
  static double distance(const Vec3d& a, const Vec3d& b) {
    Vec3d d = a - b;
    d.x -= std::round(d.x);
    d.y -= std::round(d.y);
    return d.length();
  }

  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

PeriodicPoints periodic_points(const std::vector<Vec3>& positions) {
  PeriodicPoints result;
  PointGrid grid;
  for (const Vec3& position : positions) {
    const Vec3d p(position);
    const auto fresh = static_cast<std::uint32_t>(result.points.size());
    const std::uint32_t point = grid.find_or_add(p, fresh, result.points);
    if (point == fresh) result.points.push_back(p);
    const Vec3d& home = result.points[point];
    result.vertices.push_back({point, static_cast<int>(std::lround(p.x - home.x)),
                               static_cast<int>(std::lround(p.y - home.y))});
  }
  return result;
}

/// The cage with all faces of neighbouring tiles that touch it, every point once.
class ExtendedCage {
 public:
  explicit ExtendedCage(const PolygonMesh& cage)
      : cage_(cage), points_(periodic_points(cage.positions)) {
    extended_.material_names = cage.material_names;
    add_copy(0, 0, false);
    own_faces_ = extended_.face_sizes.size();
    own_vertices_ = extended_.positions.size();
    const auto by_x = [](const auto& a, const auto& b) { return a.tile_x < b.tile_x; };
    const auto by_y = [](const auto& a, const auto& b) { return a.tile_y < b.tile_y; };
    const auto [x0, x1] = std::ranges::minmax_element(points_.vertices, by_x);
    const auto [y0, y1] = std::ranges::minmax_element(points_.vertices, by_y);
    const int reach_x = x1->tile_x - x0->tile_x;
    const int reach_y = y1->tile_y - y0->tile_y;
    for (int y = -reach_y; y <= reach_y; ++y) {
      for (int x = -reach_x; x <= reach_x; ++x) {
        if (x != 0 || y != 0) add_copy(x, y, true);
      }
    }
  }

  PolygonMesh limit(int levels) const { return limit_surface(extended_, levels, own_faces_); }

 private:
  using Key = std::tuple<std::uint32_t, int, int>;
  struct KeyHash {
    std::size_t operator()(const Key& key) const {
      const auto& [point, x, y] = key;
      const auto tile = static_cast<std::uint64_t>(x * 64 + y);
      return (point + (tile << 32)) * 0x9E3779B97F4A7C15ULL >> 7;
    }
  };

  void add_copy(int x, int y, bool only_touching) {
    std::vector<Key> face;
    const std::uint32_t* corner = cage_.corners.data();
    for (std::size_t f = 0; f < cage_.face_sizes.size(); corner += cage_.face_sizes[f++]) {
      face.clear();
      for (std::uint32_t k = 0; k < cage_.face_sizes[f]; ++k) {
        const PeriodicPoints::Vertex& v = points_.vertices[corner[k]];
        const Key key{v.point, v.tile_x + x, v.tile_y + y};
        // Corners that fell together make a face of fewer.
        if (face.empty() || (face.back() != key && face.front() != key)) face.push_back(key);
      }
      const bool touching = std::any_of(face.begin(), face.end(), [this](const Key& key) {
        const auto found = vertices_.find(key);
        return found != vertices_.end() && found->second < own_vertices_;
      });
      if (face.size() < 3 || (only_touching && !touching)) continue;
      for (const Key& key : face) extended_.corners.push_back(vertex(key));
      extended_.face_sizes.push_back(static_cast<std::uint32_t>(face.size()));
      extended_.materials.push_back(cage_.materials[f]);
    }
  }

  std::uint32_t vertex(const Key& key) {
    const auto fresh = static_cast<std::uint32_t>(extended_.positions.size());
    const auto [found, added] = vertices_.try_emplace(key, fresh);
    if (added) {
      const auto& [point, x, y] = key;
      extended_.positions.emplace_back(points_.points[point] + Vec3d(x, y, 0));
    }
    return found->second;
  }

  const PolygonMesh& cage_;
  PeriodicPoints points_;
  PolygonMesh extended_;
  std::unordered_map<Key, std::uint32_t, KeyHash> vertices_;
  std::size_t own_faces_ = 0;
  std::size_t own_vertices_ = 0;
};

}  // namespace

void set_periodic_normals(TriangleMesh& mesh) {
  const PeriodicPoints periodic = periodic_points(mesh.positions);
  std::vector<Vec3d> sums(periodic.points.size(), Vec3d(0));
  for (const auto& t : mesh.triangles) {
    const Vec3d p(mesh.positions[t[0]]);
    const Vec3d normal = (Vec3d(mesh.positions[t[1]]) - p).cross(Vec3d(mesh.positions[t[2]]) - p);
    for (const std::uint32_t vertex : t) sums[periodic.vertices[vertex].point] += normal;
  }
  mesh.normals.clear();
  for (const PeriodicPoints::Vertex& v : periodic.vertices) {
    // A point of no area has no normal; it is never seen either.
    const Vec3d& sum = sums[v.point];
    mesh.normals.push_back(sum.length() > 0 ? Vec3(sum.normalized()) : Vec3(0, 0, 1));
  }
}

PolygonMesh periodic_limit_surface(const PolygonMesh& cage, int levels) {
  return ExtendedCage(cage).limit(levels);
}

}  // namespace weft
