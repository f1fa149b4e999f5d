#include "acquisition/mesostructures/block.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weft {

namespace {

using Vec3d = Imath::V3d;

constexpr int corner_steps = 5;  // around a rounded corner
constexpr int edge_steps = 5;    // over a rounded edge in front
constexpr int back_steps = 2;    // over a rounded edge behind

/// The front's flat part as a grid, and the rings that lead from its border around to the back.
class BlockBuilder {
 public:
  explicit BlockBuilder(const BlockForm& form)
      : form_(form),
        inner_(form.width / 2 - form.rounding, form.height / 2 - form.rounding),
        columns_(steps(inner_.x)),
        rows_(steps(inner_.y)) {
    add_front();
    list_border();
  }

  TriangleMesh build() {
    std::vector<std::uint32_t> ring;
    for (const Border& b : border_) ring.push_back(b.vertex);
    const double front_edge = -form_.rounding;
    const double back_edge = form_.rounding - form_.depth;
    for (int k = 1; k <= edge_steps; ++k) {
      const double angle = std::numbers::pi / 2 * (1 - static_cast<double>(k) / edge_steps);
      ring = join(ring, next_ring(angle, front_edge));
    }
    const int side_steps = steps((front_edge - back_edge) / 2);
    for (int k = 1; k < side_steps; ++k) {
      const double part = static_cast<double>(k) / side_steps;
      ring = join(ring, next_ring(0, front_edge + part * (back_edge - front_edge)));
    }
    for (int k = 0; k < back_steps; ++k) {
      const double angle = -std::numbers::pi / 2 * k / back_steps;
      ring = join(ring, next_ring(angle, back_edge));
    }
    close(ring);
    return std::move(mesh_);
  }

 private:
  /// A point of the flat part's border and the way out from it; a corner has several.
  struct Border {
    Imath::V2d inner, out;
    std::uint32_t vertex;  // of the front
  };

  int steps(double half) const { return std::max(1, static_cast<int>(2 * half / form_.spacing)); }

  std::uint32_t add(const Vec3d& position, const Vec3d& normal) {
    mesh_.positions.emplace_back(position);
    mesh_.normals.emplace_back(normal);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a != b && b != c && c != a) mesh_.triangles.push_back({a, b, c});
  }

  Imath::V2d grid_point(int i, int j) const {
    return {inner_.x * (2.0 * i / columns_ - 1), inner_.y * (2.0 * j / rows_ - 1)};
  }
  std::uint32_t grid_vertex(int i, int j) const {
    return static_cast<std::uint32_t>(j * (columns_ + 1) + i);
  }

  void add_front() {
    for (int j = 0; j <= rows_; ++j) {
      for (int i = 0; i <= columns_; ++i) {
        const Imath::V2d p = grid_point(i, j);
        add({p.x, p.y, 0}, {0, 0, 1});
      }
    }
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        add_triangle(grid_vertex(i, j), grid_vertex(i + 1, j), grid_vertex(i + 1, j + 1));
        add_triangle(grid_vertex(i, j), grid_vertex(i + 1, j + 1), grid_vertex(i, j + 1));
      }
    }
  }

  /// Once around, counter-clockwise from the lower left corner.
  void list_border() {
    const auto side = [&](int i, int j, int di, int dj, int count, double begin_angle) {
      for (int k = 0; k < corner_steps; ++k) {
        const double angle = begin_angle + std::numbers::pi / 2 * k / corner_steps;
        border_.push_back(
            {grid_point(i, j), {std::cos(angle), std::sin(angle)}, grid_vertex(i, j)});
      }
      const double angle = begin_angle + std::numbers::pi / 2;
      for (int k = 0; k < count; ++k) {
        const int ci = i + k * di;
        const int cj = j + k * dj;
        border_.push_back(
            {grid_point(ci, cj), {std::cos(angle), std::sin(angle)}, grid_vertex(ci, cj)});
      }
    };
    side(0, 0, 1, 0, columns_, -std::numbers::pi);
    side(columns_, 0, 0, 1, rows_, -std::numbers::pi / 2);
    side(columns_, rows_, -1, 0, columns_, 0);
    side(0, rows_, 0, -1, rows_, std::numbers::pi / 2);
  }

  /// The ring where the rounded edge, around a line at height `z`, has its normal `angle` above the
  /// level.
  std::vector<std::uint32_t> next_ring(double angle, double z) {
    std::vector<std::uint32_t> ring;
    for (const Border& b : border_) {
      const Vec3d normal(b.out.x * std::cos(angle), b.out.y * std::cos(angle), std::sin(angle));
      ring.push_back(add(Vec3d(b.inner.x, b.inner.y, z) + normal * form_.rounding, normal));
    }
    return ring;
  }

  std::vector<std::uint32_t> join(const std::vector<std::uint32_t>& upper,
                                  const std::vector<std::uint32_t>& lower) {
    for (std::size_t k = 0; k < upper.size(); ++k) {
      const std::size_t next = (k + 1) % upper.size();
      add_triangle(upper[k], lower[k], lower[next]);
      add_triangle(upper[k], lower[next], upper[next]);
    }
    return lower;
  }

  /// The back: its flat part's border, each corner once, and a fan around its middle.
  void close(const std::vector<std::uint32_t>& ring) {
    std::vector<std::uint32_t> last;
    for (std::size_t k = 0; k < border_.size(); ++k) {
      const bool again = k > 0 && border_[k].vertex == border_[k - 1].vertex;
      const Imath::V2d& p = border_[k].inner;
      last.push_back(again ? last.back() : add({p.x, p.y, -form_.depth}, {0, 0, -1}));
    }
    join(ring, last);
    const std::uint32_t middle = add({0, 0, -form_.depth}, {0, 0, -1});
    for (std::size_t k = 0; k < last.size(); ++k)
      add_triangle(last[k], middle, last[(k + 1) % last.size()]);
  }

  BlockForm form_;
  Imath::V2d inner_;  // half size of the flat part
  int columns_, rows_;
  std::vector<Border> border_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh make_block(const BlockForm& form) {
  return BlockBuilder(form).build();
}

}  // namespace weft
