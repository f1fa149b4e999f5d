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
      INFO("side " << side << ", point " << at[0] << ", " << at[1]);
      REQUIRE(cell.facet == 7);
      REQUIRE(std::min({inside[0], inside[1], 1 - inside[0] - inside[1]}) > -1e-4F);
      const Barycentric again = point_of(cell, inside[0], inside[1]);
      REQUIRE(again[0] == Approx(at[0]).margin(1e-6));
      REQUIRE(again[1] == Approx(at[1]).margin(1e-6));
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
    const Barycentric again = point_of(part, inside[0], inside[1]);
    REQUIRE(again[0] == Approx(at[0]).margin(2e-6));
    REQUIRE(again[1] == Approx(at[1]).margin(2e-6));
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

TEST_CASE("a place has one key in every copy of the tile") {
  CHECK(place_key({0.25F, 0.5F, 0.1F}) == place_key({1.25F, -0.5F, 0.1F}));
  CHECK(place_key({0, 0, 0}) == place_key({1, 1, 0}));
  CHECK(place_key({0.25F, 0.5F, 0.1F}) != place_key({0.2501F, 0.5F, 0.1F}));
  CHECK(place_key({0.25F, 0.5F, 0.1F}) != place_key({0.25F, 0.5F, 0.1001F}));
}
