// Corners that cells share have one number.
#include "acquisition/cell_corners.h"

#include <set>

#include "tests/acquisition/known_structures.h"

using namespace weft;

namespace {

std::set<std::uint32_t> numbers_of(const CellCorners& corners) {
  std::set<std::uint32_t> numbers;
  for (const auto& of_cell : corners.of_cell) numbers.insert(of_cell.begin(), of_cell.end());
  return numbers;
}

}  // namespace

TEST_CASE("a place has one number in every copy of the tile") {
  PlaceNumbers numbers;
  CHECK(numbers.number({0.25F, 0.5F, 0.1F}) == 0);
  CHECK(numbers.number({0, 0, 0}) == 1);
  CHECK(numbers.number({1.25F, -0.5F, 0.1F}) == 0);
  CHECK(numbers.number({1, 1, 0}) == 1);
  CHECK(numbers.find({-0.75F, 1.5F, 0.1F}) == 0U);
  CHECK_FALSE(numbers.find({0.2501F, 0.5F, 0.1F}));
  CHECK(numbers.number({0.2501F, 0.5F, 0.1F}) == 2);
  CHECK(numbers.unshared() == 3);
  CHECK(numbers.number({0.25F, 0.5F, 0.1001F}) == 4);
  CHECK(numbers.count() == 5);
}

TEST_CASE("places keep their numbers however many come, and however many were expected") {
  constexpr std::uint32_t side = 300;
  const auto place = [](std::uint32_t i) {
    const std::uint32_t row = i / side;
    return Vec3(static_cast<float>(i % side) / side, static_cast<float>(row) / side, 0.25F);
  };
  for (const std::size_t expected : {0UL, 1000UL, 200'000UL}) {
    PlaceNumbers numbers(expected);
    std::uint32_t wrong = 0;
    for (std::uint32_t i = 0; i < side * side; ++i) {
      wrong += numbers.number(place(i)) == 2 * i ? 0 : 1;
      wrong += numbers.unshared() == 2 * i + 1 ? 0 : 1;
    }
    for (std::uint32_t i = 0; i < side * side; ++i)
      wrong += numbers.find(place(i)) == 2 * i && numbers.number(place(i)) == 2 * i ? 0 : 1;
    CHECK(wrong == 0);
    CHECK_FALSE(numbers.find({0.5F, 0.5F, 0.5F}));
    CHECK(numbers.count() == 2 * side * side);
  }
}

TEST_CASE("neighbours share their corners, across the tile's border too, and no number is unused") {
  // Two triangles cover the tile: all their corners are one place of the endless surface.
  const std::vector<Facet> facets = facets_of(test::flat(Rgb(1)).mesh);
  REQUIRE(facets.size() == 2);
  const std::array<Barycentric, 3> whole{Barycentric{0, 0}, Barycentric{1, 0}, Barycentric{0, 1}};
  const std::vector<Cell> wholes{{0, whole}, {1, whole}};
  for (const int side : {1, 2, 4}) {
    PlaceNumbers numbers;
    const CellCorners corners = cell_corners(facets, wholes, side, numbers);
    INFO("side " << side);
    CHECK(corners.of_cell.size() == static_cast<std::size_t>(side) * side * 2);
    // A periodic lattice of side * side places.
    CHECK(corners.count == static_cast<std::size_t>(side) * side);
    CHECK(numbers_of(corners).size() == corners.count);
    std::set<std::uint32_t> rim;
    for (const Vec3& point : rim_of(facets[0], wholes[0], side)) {
      const auto number = numbers.find(point);
      REQUIRE(number);
      rim.insert(*number);
    }
    CHECK(rim.size() == 3U * side - 2);  // the three corners are one
  }
}

TEST_CASE("corners follow the order of the cells") {
  const std::vector<Facet> facets = facets_of(test::flat(Rgb(1)).mesh);
  const Cell whole{0, {Barycentric{0.1F, 0.1F}, Barycentric{0.5F, 0.1F}, Barycentric{0.1F, 0.5F}}};
  PlaceNumbers numbers;
  const CellCorners corners = cell_corners(facets, std::span(&whole, 1), 3, numbers);
  std::vector<Cell> cells;
  cut(whole, 3, cells);
  REQUIRE(corners.of_cell.size() == cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [u, v] = cells[c].corners[k];
      const auto number = numbers.find(facets[0].point(u, v));
      // The one place inside is not to be asked for.
      if (number) CHECK(corners.of_cell[c][k] == *number);
      if (!number) CHECK(corners.of_cell[c][k] < corners.count);
    }
  }
}
