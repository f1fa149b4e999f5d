// Triangulation, location and solid angles of hemisphere samplings.
#include "btf/hemisphere_sampling.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <tuple>

#include "btf/error.h"
#include "btf/random.h"

using namespace weft;

namespace {

Direction random_direction(std::uint64_t i) {
  const float z = unit_float(hash_coordinates(1, i));
  const float phi = 2 * std::numbers::pi_v<float> * unit_float(hash_coordinates(2, i));
  const float r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

const char* const set_names[] = {"ubo81", "ubo151", "regular:16x8", "fibonacci:1024",
                                 "fibonacci:7"};

}  // namespace

TEST_CASE("named sets have their sizes and rings") {
  CHECK(named_directions("ubo81").size() == 81);
  CHECK(named_directions("ubo151").size() == 151);
  CHECK(named_directions("regular:16x8").size() == 128);
  const std::vector<Direction> ubo = named_directions("ubo81");
  CHECK(degrees(theta_of(ubo[80])) == Approx(75));
  CHECK(degrees(phi_of(ubo[8])) == Approx(30));
  const std::vector<Direction> dome = named_directions("ubo151");
  std::size_t begin = 0;
  for (const auto& [theta, count, offset] :
       std::vector<std::tuple<double, std::size_t, double>>{{0, 1, 0},
                                                            {11, 6, 15},
                                                            {23.5, 12, 0},
                                                            {30, 12, 15},
                                                            {37.5, 12, 0},
                                                            {45, 18, 0},
                                                            {52.5, 18, 7.5},
                                                            {60, 24, 0},
                                                            {67.5, 24, 7.5},
                                                            {75, 24, 0}}) {
    for (std::size_t i = 0; i < count; ++i) {
      const double phi =
          radians(offset + 360.0 * static_cast<double>(i) / static_cast<double>(count));
      CHECK((dome[begin + i] - from_spherical(radians(theta), phi)).length() < 1e-5F);
    }
    begin += count;
  }
  CHECK(begin == dome.size());
  for (const Direction& d : named_directions("fibonacci:1024")) {
    CHECK(degrees(theta_of(d)) <= 89.9F + 1e-3F);
  }
  CHECK_THROWS_WITH(named_directions("ubo82"), Catch::Contains("ubo81"));
  CHECK_THROWS_AS(named_directions("regular:0x8"), Error);
  CHECK_THROWS_AS(named_directions("file:nowhere.csv"), Error);
}

TEST_CASE("triangles cover the hull once and their circles are empty") {
  for (const char* name : set_names) {
    INFO(name);
    const HemisphereSampling sampling(named_directions(name));
    const auto& tables = sampling.tables();
    // Euler: a triangulation of n points with h of them on the hull has 2 n - 2 - h triangles.
    CHECK(sampling.triangles().size() == 2 * sampling.size() - 2 - tables.hull.size());
    for (const auto& [a, b, c] : sampling.triangles()) {
      const Imath::V2d pa(tables.points[a]), pb(tables.points[b]), pc(tables.points[c]);
      const Imath::V2d ab = pb - pa, ac = pc - pa;
      const double d = 2 * (ab.x * ac.y - ab.y * ac.x);
      REQUIRE(d > 0);
      const Imath::V2d centre = pa + Imath::V2d(ac.y * ab.length2() - ab.y * ac.length2(),
                                                ab.x * ac.length2() - ac.x * ab.length2()) /
                                         d;
      const double radius = (pa - centre).length();
      for (const Vec2& p : tables.points) {
        REQUIRE((Imath::V2d(p) - centre).length() > radius - 1e-5);
      }
    }
  }
}

TEST_CASE("co-circular ties go to the lowest index") {
  // The first ring's hexagon around the pole: six triangles from direction 0. Each quad between
  // rings is cut from its lowest corner, so rebuilding from the stored triangles changes nothing.
  const HemisphereSampling sampling(named_directions("ubo81"));
  std::set<std::uint16_t> around_pole;
  for (const auto& t : sampling.triangles()) {
    if (t[0] == 0 || t[1] == 0 || t[2] == 0) around_pole.insert(t.begin(), t.end());
  }
  CHECK(around_pole == std::set<std::uint16_t>{0, 1, 2, 3, 4, 5, 6});
  // Four corners of a square: fanned from corner 0.
  const HemisphereSampling square({from_spherical(0.5, 0), from_spherical(0.5, 1.5707963267948966),
                                   from_spherical(0.5, 3.141592653589793),
                                   from_spherical(0.5, 4.71238898038469)});
  REQUIRE(square.triangles().size() == 2);
  CHECK(square.triangles()[0][0] == 0);
  CHECK(square.triangles()[1][0] == 0);
}

TEST_CASE("weights reproduce linear functions of the parabolic plane inside the hull") {
  for (const char* name : set_names) {
    INFO(name);
    const HemisphereSampling sampling(named_directions(name));
    for (std::uint64_t i = 0; i < 3000; ++i) {
      const Direction d = random_direction(i);
      const Stencil s = sampling.locate(d);
      float sum = 0;
      Vec2 p(0, 0);
      for (int k = 0; k < 3; ++k) {
        REQUIRE(s.weight[k] >= 0);
        REQUIRE(s.weight[k] <= 1.00001F);
        sum += s.weight[k];
        p += parabolic(sampling[s.index[k]]) * s.weight[k];
      }
      REQUIRE(sum == Approx(1).margin(1e-5));
      const bool outside = s.weight[2] == 0;
      if (!outside) REQUIRE((p - parabolic(d)).length() < 2e-5F);
    }
  }
}

TEST_CASE("a sample's own direction answers with that sample") {
  for (const char* name : set_names) {
    const HemisphereSampling sampling(named_directions(name));
    for (std::size_t i = 0; i < sampling.size(); ++i) {
      const Stencil s = sampling.locate(sampling[i]);
      float weight = 0;
      for (int k = 0; k < 3; ++k) weight += s.index[k] == i ? s.weight[k] : 0;
      REQUIRE(weight == Approx(1).margin(2e-4));
    }
  }
}

TEST_CASE("beyond the hull, hold answers with the nearest point of the hull") {
  const HemisphereSampling sampling(named_directions("ubo81"));
  const auto& tables = sampling.tables();
  for (std::uint64_t i = 0; i < 500; ++i) {
    const double phi = 6.28 * unit_float(hash_coordinates(3, i));
    const Direction d = from_spherical(radians(89.0), phi);
    const Stencil s = sampling.locate(d);
    const Vec2 held = parabolic(sampling[s.index[0]]) * s.weight[0] +
                      parabolic(sampling[s.index[1]]) * s.weight[1];
    float least = 1e9F;
    for (std::size_t e = 0; e < tables.hull.size(); ++e) {
      const Vec2 a = tables.points[tables.hull[e]];
      const Vec2 along = tables.points[tables.hull[(e + 1) % tables.hull.size()]] - a;
      const float t = std::clamp(((parabolic(d) - a) ^ along) / along.length2(), 0.0F, 1.0F);
      least = std::min(least, (parabolic(d) - a - along * t).length());
    }
    REQUIRE((held - parabolic(d)).length() == Approx(least).margin(1e-6));
  }
}

TEST_CASE("fade goes to zero at the horizon") {
  const HemisphereSampling sampling(named_directions("ubo81"), Horizon::fade);
  const auto sum = [&](double theta) {
    const Stencil s = sampling.locate(from_spherical(radians(theta), 0.4));
    return s.weight[0] + s.weight[1] + s.weight[2];
  };
  CHECK(sum(60) == Approx(1));
  CHECK(sum(80) < 0.8F);
  CHECK(sum(80) > sum(85));
  CHECK(sum(89.9) < 0.05F);
}

TEST_CASE("solid angles sum to the hemisphere and equal areas are equal") {
  for (const char* name : set_names) {
    const std::vector<double> areas = HemisphereSampling(named_directions(name)).solid_angles();
    CHECK(std::accumulate(areas.begin(), areas.end(), 0.0) ==
          Approx(2 * std::numbers::pi).epsilon(1e-9));
  }
  const std::vector<double> areas =
      HemisphereSampling(named_directions("fibonacci:1024")).solid_angles();
  for (std::size_t i = 0; i < 900; ++i)
    CHECK(areas[i] == Approx(2 * std::numbers::pi / 1024).epsilon(0.08));
  CHECK(HemisphereSampling({{0, 0, 1}}).solid_angles()[0] == Approx(2 * std::numbers::pi));
  const auto halves =
      HemisphereSampling({from_spherical(0.4, 0), from_spherical(0.4, std::numbers::pi)})
          .solid_angles();
  CHECK(halves[0] == Approx(std::numbers::pi));
}

TEST_CASE("few or collinear directions answer with the nearest") {
  const HemisphereSampling one({{0, 0, 1}});
  CHECK(one.locate(from_spherical(1.2, 1)).weight[0] == 1);
  const HemisphereSampling line(
      {from_spherical(0.3, 0), from_spherical(0.6, 0), from_spherical(1.0, 0)});
  CHECK(line.triangles().empty());
  CHECK(line.locate(from_spherical(0.9, 0.2)).index[0] == 2);
}

TEST_CASE("directions that cannot be are refused") {
  CHECK_THROWS_WITH(HemisphereSampling({}), Catch::Contains("0 directions"));
  CHECK_THROWS_WITH(HemisphereSampling({{0, 0, 1}, {0, 0, -1}}), Catch::Contains("direction 1"));
  CHECK_THROWS_WITH(HemisphereSampling({{0, 0, 1}, {0, 0, 1}}),
                    Catch::Contains("repeats direction 0"));
  CHECK_THROWS_AS(HemisphereSampling({{0, 0, 2}}), Error);
  CHECK_THROWS_AS(HemisphereSampling({{0, 0, 1}}, {{0, 0, 5}}), Error);
}

TEST_CASE("triangulations of a file that cannot be searched are refused") {
  std::vector<Direction> directions;
  for (const int degrees : {0, 60, 120, 200, 260}) {
    directions.push_back(from_spherical(radians(60.0), radians(static_cast<double>(degrees))));
  }
  using Triangles = std::vector<std::array<std::uint16_t, 3>>;
  // Two triangles that meet in direction 2 only.
  CHECK_THROWS_WITH(HemisphereSampling(directions, Triangles{{0, 1, 2}, {2, 3, 4}}),
                    Catch::Contains("direction 2"));
  CHECK_THROWS_WITH(HemisphereSampling(directions, Triangles(32768, {0, 1, 2})),
                    Catch::Contains("32768") && Catch::Contains("32767"));
}

TEST_CASE("a NaN is located within the directions") {
  const HemisphereSampling sampling(named_directions("ubo81"));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Direction& d :
       {Direction(nan, 0, 1), Direction(0, nan, 1), Direction(nan, nan, nan)}) {
    for (const std::uint16_t index : sampling.locate(d).index) CHECK(index < sampling.size());
  }
}
