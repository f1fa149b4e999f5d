// Energies of light fields and reflectance fields on BTFs whose asymmetry is known.

#include "study/asymmetry.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

using namespace weft;

namespace {

/// f = B / cos(theta_light).
using Formula = std::function<float(const Direction& light, const Direction& view)>;

Btf btf_of(const std::string& lights, const std::string& views, const Formula& f) {
  Btf btf(2, 1, HemisphereSampling(named_directions(views)),
          HemisphereSampling(named_directions(lights)), PixelType::float32);
  for (std::size_t v = 0; v < btf.views().size(); ++v) {
    for (std::size_t l = 0; l < btf.lights().size(); ++l) {
      const Direction& light = btf.lights()[l];
      btf.set(l, v, 1, 0, Rgb(f(light, btf.views()[v]) * light.z));
    }
  }
  return btf;
}

}  // namespace

TEST_CASE("A reciprocal BRDF has the same energies in light fields and reflectance fields") {
  const Btf btf = btf_of("ubo81", "ubo81", [](const Direction& l, const Direction& v) {
    return 0.2F + std::pow((l + v).normalized().z, 20.F);
  });
  const FieldEnergies energies = field_energies(btf, 1, 0);
  for (std::size_t i = 0; i < 81; ++i)
    CHECK(energies.light_fields[i] == Approx(energies.reflectance_fields[i]));
  CHECK(asymmetry(btf, energies) == Approx(0).margin(1e-5));
  const FieldEnergies black = field_energies(btf, 0, 0);
  CHECK(asymmetry(btf, black) == 0);
  CHECK(roughness(btf.views(), black.reflectance_fields) == 0);
}

TEST_CASE("A constant BRDF has the number of views, or of lights, as energy, and no roughness") {
  const Btf btf = btf_of("regular:3x6", "ubo81", [](const auto&, const auto&) { return 0.5F; });
  const FieldEnergies energies = field_energies(btf, 1, 0);
  REQUIRE(energies.light_fields.size() == 18);
  REQUIRE(energies.reflectance_fields.size() == 81);
  for (const double e : energies.light_fields) CHECK(e == Approx(0.5 * 81));
  for (const double e : energies.reflectance_fields) CHECK(e == Approx(0.5 * 18));
  CHECK(roughness(btf.lights(), energies.light_fields) == Approx(0).margin(1e-6));
  CHECK(asymmetry(btf, energies) == 0);
}

TEST_CASE("Masking that only the view sees makes the reflectance fields the rough ones") {
  const Btf btf = btf_of("ubo81", "ubo81", [](const Direction& l, const Direction& v) {
    const float seen = std::sin(9 * v.x) * std::sin(7 * v.y) > 0 ? 1.F : 0.2F;
    return seen * (1 + 0.3F * l.x);
  });
  const FieldEnergies energies = field_energies(btf, 1, 0);
  CHECK(roughness(btf.views(), energies.reflectance_fields) >
        4 * roughness(btf.lights(), energies.light_fields));
  CHECK(asymmetry(btf, energies) > 0.1);
  // Each light's energy is that of the views' mean, times its own factor.
  double seen = 0;
  for (const Direction& v : btf.views().directions())
    seen += std::sin(9 * v.x) * std::sin(7 * v.y) > 0 ? 1.0 : 0.2;
  for (std::size_t l = 0; l < 81; ++l)
    CHECK(energies.light_fields[l] == Approx(seen * (1 + 0.3 * btf.lights()[l].x)).epsilon(1e-4));
}

TEST_CASE("Roughness is the mean step between neighbours over the mean") {
  const HemisphereSampling sampling(
      {from_spherical(0, 0), from_spherical(1, 0), from_spherical(1, 2), from_spherical(1, 4)});
  // Edges: the pole with each of three (differences 3), and the three among each other (0).
  const std::vector<double> series{4, 1, 1, 1};
  CHECK(roughness(sampling, series) == Approx(1.5 / 1.75));
}
