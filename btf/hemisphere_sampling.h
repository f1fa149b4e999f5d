// A finite set of directions on the upper hemisphere, and how to interpolate between them.
//
// Directions are joined by a Delaunay triangulation of their parabolic images (x, y) / (1 + z).
// Beyond the lowest ring the nearest edge of the hull answers (`Horizon::hold`), or weights fade to
// zero towards the horizon as in Bonn's reader (`Horizon::fade`). One, two or collinear directions:
// nearest. What is interpolated is B / cos(theta_light); see `raw_appearance.h`.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "btf/direction.h"

namespace weft {

enum class Horizon { hold, fade };

/// Three neighbours of a direction and their barycentric weights. Weights are in [0, 1]; they sum
/// to 1 with `Horizon::hold` and to at most 1 with `Horizon::fade`. Unused entries have weight 0
/// and a valid index.
struct Stencil {
  std::array<std::uint16_t, 3> index;
  std::array<float, 3> weight;
};

class HemisphereSampling {
 public:
  /// Width and height of the grid over the parabolic disc's square [-1, 1]^2 that starts a search.
  static constexpr int grid_size = 256;

  /// @param directions  1 to 16,000 unit vectors, z >= 0, all distinct (to 1e-4 rad).
  /// @throws Error      naming the first direction that is not so.
  explicit HemisphereSampling(std::vector<Direction> directions, Horizon horizon = Horizon::hold);

  /// With a triangulation that is already known (from `btf.json`), so that all readers agree.
  /// @throws Error  where a triangle names a direction that is not there.
  HemisphereSampling(std::vector<Direction> directions,
                     std::vector<std::array<std::uint16_t, 3>> triangles,
                     Horizon horizon = Horizon::hold);

  std::size_t size() const { return directions_.size(); }
  std::span<const Direction> directions() const { return directions_; }
  const Direction& operator[](std::size_t i) const { return directions_[i]; }
  Horizon horizon() const { return horizon_; }

  /// Counter-clockwise in the parabolic plane; empty where the directions do not span a triangle.
  std::span<const std::array<std::uint16_t, 3>> triangles() const { return triangles_; }

  /// Neighbours of `direction` (unit, z >= 0). Constant time: the grid names a triangle nearby, a
  /// walk ends it.
  Stencil locate(const Direction& direction) const;

  /// Index of the direction with the least angle to `direction`; ties go to the lowest index.
  std::uint16_t nearest(const Direction& direction) const;

  /// Solid angle that each direction stands for, in sr: spherical Voronoi cells clipped at z = 0.
  /// They sum to 2 pi.
  std::vector<double> solid_angles() const;

  /// The tables that `locate` walks, for a twin of it in GLSL.
  struct Tables {
    /// Set in a neighbour that is not a triangle: the rest of its bits name an edge of the hull.
    static constexpr std::uint16_t hull_flag = 0x8000;
    /// Parabolic image of each direction; with `Horizon::fade` the points of the ring below the
    /// horizon follow, whose index is >= size() and whose weight counts as 0.
    std::vector<Vec2> points;
    /// Vertices of a triangle, then its neighbour across the edge opposite to each vertex: a
    /// triangle, or `hull_flag | k` where that edge runs from hull[k] to hull[k + 1].
    std::vector<std::array<std::uint16_t, 6>> triangles;
    std::vector<std::uint16_t> grid;  ///< grid_size^2 triangles, row by row from y = -1
    std::vector<std::uint16_t> hull;  ///< points around the hull, counter-clockwise
  };
  const Tables& tables() const { return tables_; }

 private:
  void prepare();
  void fill_grid();
  std::uint16_t walk(std::uint16_t triangle, const Vec2& p, std::array<float, 3>& weight) const;
  Stencil hold(std::size_t edge, const Vec2& p) const;
  Stencil nearest_stencil(const Direction& direction) const;

  std::vector<Direction> directions_;
  std::vector<std::array<std::uint16_t, 3>> triangles_;
  Horizon horizon_;
  Tables tables_;
};

/// The directions of a named set: `ubo81`, `ubo151`, `regular:THETAxPHI` (cell centres),
/// `fibonacci:N` (equal area), `file:NAME.csv` (header `theta,phi`, degrees).
/// @throws Error  listing the valid names.
std::vector<Direction> named_directions(const std::string& name);

}  // namespace weft
