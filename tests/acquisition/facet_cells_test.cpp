// Facets cut into cells: which cell a point is in, and where in it.
#include "acquisition/facet_cells.h"

#include <cmath>

#include "btf/random.h"
#include "tests/acquisition/known_structures.h"

using namespace weft;

namespace {

const Cell whole{7, {Barycentric{0, 0}, Barycentric{1, 0}, Barycentric{0, 1}}};

// Uniform in the triangle.
Barycentric point(int i) {
  const float root = std::sqrt(unit_float(hash_coordinates(i, 0)));
  const float share = unit_float(hash_coordinates(i, 1));
  return {root * (1 - share), root * share};
}

// Of a cell that `at` is said to lie in, at `inside`.
void require_same_place(const Cell& cell, const Barycentric& inside, const Barycentric& at) {
  INFO("point " << at[0] << ", " << at[1]);
  REQUIRE(std::min({inside[0], inside[1], 1 - inside[0] - inside[1]}) > -1e-4F);
  const Barycentric again = point_of(cell, inside[0], inside[1]);
  REQUIRE(again[0] == Approx(at[0]).margin(2e-6));
  REQUIRE(again[1] == Approx(at[1]).margin(2e-6));
}

}  // namespace

TEST_CASE("a point is found in the cell that holds it, at the same place") {
  for (const int side : {1, 2, 3, 4, 7, 128}) {
    std::vector<Cell> cells;
    cut(whole, side, cells);
    REQUIRE(cells.size() == static_cast<std::size_t>(side) * side);
    for (int i = 0; i < 2000; ++i) {
      const Barycentric at = point(i);
      Barycentric inside = at;
      const Cell& cell = cells.at(enter(side, inside));
      INFO("side " << side);
      REQUIRE(cell.facet == 7);
      require_same_place(cell, inside, at);
    }
  }
}

TEST_CASE("cells of a cell are found like those of a facet") {
  std::vector<Cell> cells;
  cut(whole, 3, cells);
  for (int i = 0; i < 2000; ++i) {
    const Barycentric at = point(i);
    Barycentric inside = at;
    std::vector<Cell> parts;
    cut(cells.at(enter(3, inside)), 4, parts);
    REQUIRE(parts.size() == 16);
    const Cell& part = parts.at(enter(4, inside));
    require_same_place(part, inside, at);
  }
}

TEST_CASE("random points of a cell lie in it, four in a row in its four quarters") {
  std::vector<Cell> cells;
  cut(whole, 2, cells);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    std::array<int, 4> quarters{};
    for (int round = 0; round < 400; ++round) {
      Barycentric at = random_point(cells[c], c, round);
      REQUIRE(enter(2, at) == c);
      ++quarters.at(enter(2, at));
    }
    for (const int count : quarters) CHECK(count == 100);
  }
}

TEST_CASE("the cells of all facets are numbered one after the other") {
  const std::vector<Facet> facets = facets_of(test::rings(32, 8).mesh);
  const FacetCells cells(facets);
  const std::vector<Cell> all = cells.all();
  REQUIRE(cells.facets() == facets.size());
  REQUIRE(cells.count() == all.size());
  REQUIRE(cells.count() > facets.size());  // the plane's are cut
  for (int i = 0; i < 2000; ++i) {
    const std::uint32_t f = i % 4 == 0 ? i % 2 : static_cast<std::uint32_t>(i % facets.size());
    const Barycentric at = point(i);
    Barycentric inside = at;
    const Cell& cell = all.at(cells.find(f, inside));
    REQUIRE(cell.facet == f);
    require_same_place(cell, inside, at);
  }
}
