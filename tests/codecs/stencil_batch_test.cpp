// Sixteen stencils at once against `HemisphereSampling::locate`.

#include "codecs/stencil_batch.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "btf/random.h"

using namespace weft;

namespace {

// A direction may lie on the border of two triangles: what counts is where the stencil points.
Direction blended(const HemisphereSampling& sampling, const Stencil& stencil) {
  Direction sum(0, 0, 0);
  for (std::size_t i = 0; i < 3; ++i) sum += sampling[stencil.index[i]] * stencil.weight[i];
  return sum;
}

}  // namespace

TEST_CASE("Sixteen stencils at once are those of one at a time") {
  for (const Horizon horizon : {Horizon::hold, Horizon::fade}) {
    for (const std::string name : {"ubo81", "regular:3x8", "fibonacci:700", "fibonacci:2"}) {
      const HemisphereSampling sampling(named_directions(name), horizon);
      const BatchLocator locator(sampling);
      for (std::uint64_t batch = 0; batch < 200; ++batch) {
        std::array<Direction, batch_lanes> directions;
        for (std::uint64_t i = 0; i < batch_lanes; ++i) {
          directions[i] = from_spherical(
              std::acos(static_cast<double>(unit_float(hash_coordinates(5, batch, i, 0)))),
              radians(360.0 * unit_float(hash_coordinates(5, batch, i, 1))));
        }
        directions[3] = sampling[batch % sampling.size()];
        const StencilBatch found = locator.locate(sampling, directions);
        for (std::size_t i = 0; i < batch_lanes; ++i) {
          INFO(name << ' ' << directions[i]);
          const Direction expected = blended(sampling, sampling.locate(directions[i]));
          REQUIRE((blended(sampling, found.lane(i)) - expected).length() < 1e-5F);
          for (std::size_t k = 0; k < 3; ++k) REQUIRE(found.weight[k][i] >= 0);
        }
      }
    }
  }
}
