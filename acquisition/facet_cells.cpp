#include "acquisition/facet_cells.h"

#include <cmath>

#include "btf/random.h"

namespace weft {

namespace {

constexpr float cell_size = 1.0F / 96;  // tiles; longest edge of a cell
constexpr int most_cells_a_side = 128;

int cells_a_side(const Facet& facet) {
  if (facet.degenerate()) return 1;
  const float longest = std::max(
      {facet.edge_u.length(), facet.edge_v.length(), (facet.edge_u - facet.edge_v).length()});
  return std::clamp(static_cast<int>(std::ceil(longest / cell_size)), 1, most_cells_a_side);
}

}  // namespace

FacetCells::FacetCells(const std::vector<Facet>& facets) {
  wholes_.reserve(facets.size());
  for (const Facet& facet : facets) {
    const int side = cells_a_side(facet);
    wholes_.push_back({count_, side});
    count_ += static_cast<std::uint32_t>(side * side);
  }
}

std::vector<Cell> FacetCells::all() const {
  constexpr std::array<Barycentric, 3> corners{Barycentric{0, 0}, Barycentric{1, 0},
                                               Barycentric{0, 1}};
  std::vector<Cell> cells;
  cells.reserve(count_);
  for (std::uint32_t f = 0; f < wholes_.size(); ++f) cut({f, corners}, wholes_[f].side, cells);
  return cells;
}

Barycentric point_of(const Cell& cell, float a, float b) {
  const auto& [p, q, r] = cell.corners;
  return {p[0] + (q[0] - p[0]) * a + (r[0] - p[0]) * b,
          p[1] + (q[1] - p[1]) * a + (r[1] - p[1]) * b};
}

void cut(const Cell& whole, int side, std::vector<Cell>& cells) {
  const auto at = [&](const std::array<int, 2>& place) {
    return point_of(whole, static_cast<float>(place[0]) / static_cast<float>(side),
                    static_cast<float>(place[1]) / static_cast<float>(side));
  };
  for_each_cell(side, [&](const auto& p, const auto& q, const auto& r) {
    cells.push_back({whole.facet, {at(p), at(q), at(r)}});
  });
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

}  // namespace weft
