// The points of one texel's samples: drawn sixteen at a time, and put in an order along a curve.
#include "acquisition/sample_points.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>

#include "btf/random.h"
#include "tracer/sobol.h"

using namespace weft;

static_assert(reverse_bits(1U) == 0x80000000U);
static_assert(reverse_bits(0x12345678U) == 0x1E6A2C48U);

TEST_CASE("the points of a texel's samples are Sobol's, whatever their first and number") {
  SamplePoints points;
  for (const auto& [first, count] : {std::array<std::uint32_t, 2>{0, 64},
                                     {0, 1},
                                     {64, 64},
                                     {16, 16},
                                     {3, 21},
                                     {1U << 24U, 33}}) {
    const std::uint64_t key = hash_coordinates(first, count);
    points.draw(key, first, count);
    for (std::uint32_t i = 0; i < count; ++i) REQUIRE(points[i] == sobol_point(first + i, key));
  }
}

TEST_CASE("the curve through a texel's points meets each once, sixteen in a quarter of the texel") {
  SamplePoints points;
  for (std::uint64_t key = 0; key < 20; ++key) {
    points.draw(hash_coordinates(key), 64, SamplePoints::most);
    const auto order = points.along_curve();
    REQUIRE(std::set(order.begin(), order.end()).size() == SamplePoints::most);
    for (std::size_t k = 0; k < order.size(); ++k) {
      const auto [x, y] = points[order[k]];
      const std::size_t quarter = (x >= 0.5F ? 1U : 0U) + (y >= 0.5F ? 2U : 0U);
      REQUIRE(quarter == k / lanes);
    }
  }
}

TEST_CASE("the curve serves any number of points") {
  SamplePoints points;
  for (std::uint32_t count = 1; count <= SamplePoints::most; ++count) {
    points.draw(hash_coordinates(count), 5, count);
    const auto order = points.along_curve();
    REQUIRE(order.size() == count);
    REQUIRE(std::set(order.begin(), order.end()).size() == count);
    REQUIRE(std::ranges::max(order) == count - 1);
  }
}
