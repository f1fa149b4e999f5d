// Sixteen stencils at once against `HemisphereSampling::locate` and `bilinear_texels`.

#include "codecs/stencil_batch.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

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
    for (const std::string name :
         {"ubo81", "regular:3x8", "regular:2x3", "fibonacci:700", "fibonacci:3", "fibonacci:2"}) {
      const HemisphereSampling sampling(named_directions(name), horizon);
      const BatchLocator locator(sampling);
      for (std::uint64_t batch = 0; batch < 200; ++batch) {
        Batch<Direction> directions;
        for (std::uint64_t i = 0; i < batch_lanes; ++i) {
          directions[i] = from_spherical(
              std::acos(static_cast<double>(unit_float(hash_coordinates(5, batch, i, 0)))),
              radians(360.0 * unit_float(hash_coordinates(5, batch, i, 1))));
        }
        directions[3] = sampling[batch % sampling.size()];
        directions[4] = Direction(1, 0, 0);
        DirectionLanes asked;
        for (std::size_t i = 0; i < batch_lanes; ++i) {
          asked.x[i] = directions[i].x;
          asked.y[i] = directions[i].y;
          asked.z[i] = directions[i].z;
        }
        const StencilBatch found = locator.locate(sampling, asked);
        for (std::size_t i = 0; i < batch_lanes; ++i) {
          INFO(name << ' ' << directions[i]);
          const Direction expected = blended(sampling, sampling.locate(directions[i]));
          Stencil stencil;
          for (std::size_t k = 0; k < 3; ++k) {
            stencil.index[k] = static_cast<std::uint16_t>(found[i].index[k]);
            stencil.weight[k] = found[i].weight[k];
            REQUIRE(stencil.index[k] < sampling.size());
            REQUIRE(stencil.weight[k] >= 0);
          }
          REQUIRE((blended(sampling, stencil) - expected).length() < 1e-5F);
          REQUIRE(found[i].weight[3] == 0);
        }
      }
    }
  }
}

TEST_CASE("Sixteen times four texels at once are those of one at a time") {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Texcoord> places{{0, 0},     {1, 1},          {-1, 2},    {0.5F, 0.25F},
                                     {nan, 0},   {0.1F, nan},     {1e9F, -7}, {-0.2F, -3.9F},
                                     {1e38F, 0}, {-1e-9F, 1e-9F}, {0.99F, 0}, {0.01F, 0.995F}};
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(5, 3), std::pair(64, 2)}) {
    std::vector<AppearanceQuery> asked;
    for (const Texcoord& uv : places) asked.push_back({uv, {0, 0, 1}, {0, 0, 1}});
    const TexelBatch found = texel_batch(query_batch(asked), width, height);
    for (std::size_t i = 0; i < batch_lanes; ++i) {
      const Texcoord uv = places[std::min(i, places.size() - 1)];
      INFO(uv << " of " << width << " x " << height);
      const TexelStencil expected = bilinear_texels(uv, width, height);
      for (std::size_t t = 0; t < 4; ++t) {
        const TexelStencil lane = found.lane(i);
        if (std::isnan(expected.weight[t])) {
          REQUIRE(lane.index[t] < static_cast<std::uint32_t>(width * height));
          REQUIRE(std::isnan(lane.weight[t]));
        } else {
          REQUIRE(lane.index[t] == expected.index[t]);
          REQUIRE(std::abs(lane.weight[t] - expected.weight[t]) <= 1e-6F);
        }
      }
    }
  }
}
