#include "acquisition/facet_cells.h"

#include <cmath>

#include "btf/random.h"

namespace weft {

namespace {

constexpr float cell_size = 1.0F / 96;  // tiles; longest edge of a cell
constexpr int most_cells_a_side = 128;

}  // namespace

int cells_a_side(const Facet& facet) {
  if (facet.degenerate()) return 1;
  const float longest = std::max(
      {facet.edge_u.length(), facet.edge_v.length(), (facet.edge_u - facet.edge_v).length()});
  return std::clamp(static_cast<int>(std::ceil(longest / cell_size)), 1, most_cells_a_side);
}

Barycentric point_of(const Cell& cell, float a, float b) {
  const auto& [p, q, r] = cell.corners;
  return {p[0] + (q[0] - p[0]) * a + (r[0] - p[0]) * b,
          p[1] + (q[1] - p[1]) * a + (r[1] - p[1]) * b};
}

void cut(const Cell& whole, int side, std::vector<Cell>& cells) {
  const auto at = [&](int i, int j) {
    return point_of(whole, static_cast<float>(i) / static_cast<float>(side),
                    static_cast<float>(j) / static_cast<float>(side));
  };
  for (int i = 0; i < side; ++i) {
    for (int position = 0; position < 2 * (side - i) - 1; ++position) {
      const int j = position / 2;
      if (position % 2 == 0) {
        cells.push_back({whole.facet, {at(i, j), at(i + 1, j), at(i, j + 1)}});
      } else {
        cells.push_back({whole.facet, {at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)}});
      }
    }
  }
}

Barycentric random_point(const Cell& cell, std::size_t number, int round) {
  const std::uint64_t bits = hash_coordinates(number, round);
  std::array<float, 2> at{unit_float(bits), unit_float(bits << 32)};
  if (at[0] + at[1] > 1) at = {1 - at[0], 1 - at[1]};
  // Quarters: the one in the middle is turned round, the others touch a corner.
  const int quarter = round % 4;
  if (quarter == 0) return point_of(cell, (1 - at[0]) / 2, (1 - at[1]) / 2);
  return point_of(cell, (at[0] + (quarter == 2 ? 1.0F : 0.0F)) / 2,
                  (at[1] + (quarter == 3 ? 1.0F : 0.0F)) / 2);
}

std::uint64_t place_key(const Vec3& point) {
  constexpr double steps = 1e6;
  const auto wrapped = [&](float x) {
    return std::llround((x - std::floor(x)) * steps) % static_cast<std::int64_t>(steps);
  };
  return hash_coordinates(wrapped(point.x), wrapped(point.y), std::llround(point.z * steps));
}

}  // namespace weft
