// Energy, reciprocity and sampling of the modelled materials.
#include "tracer/bsdf.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

#include "btf/error.h"
#include "tracer/sobol.h"

using namespace weft;

namespace {

Direction tilted(float degrees_from_normal) {
  return from_spherical(radians(degrees_from_normal), 0.7F);
}

// Mean of the weights of samples: the directional albedo.
Imath::V3d sampled_albedo(const Bsdf& bsdf, const Direction& view, std::uint32_t samples) {
  Imath::V3d sum(0, 0, 0);
  for (std::uint32_t s = 0; s < samples; ++s) {
    const auto [u, v] = sobol_point(s, 11);
    const auto [lobe, unused] = sobol_point(s, 12);
    const Bsdf::Sample sample = bsdf.sample(view, {lobe, u, v});
    if (sample.pdf > 0) sum += Imath::V3d(sample.weight);
  }
  return sum / samples;
}

// The same by a product grid over the hemisphere, with no sampling of ours.
double integrated_albedo(const Bsdf& bsdf, const Direction& view, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const float z = (static_cast<float>(i) + 0.5F) / static_cast<float>(n);
    for (int j = 0; j < n; ++j) {
      const double phi = 2 * std::numbers::pi * (j + 0.5) / n;
      sum += bsdf.evaluate(from_spherical(std::acos(z), phi), view).x;
    }
  }
  return sum * 2 * std::numbers::pi / (static_cast<double>(n) * n);
}

}  // namespace

TEST_CASE("white materials send back all light, at any roughness and angle") {
  for (const float alpha : {1e-4F, 0.001F, 0.05F, 0.3F, 0.7F, 1.0F}) {
    for (const float angle : {0.0F, 30.0F, 60.0F, 80.0F, 88.0F}) {
      INFO("alpha " << alpha << ", theta " << angle);
      const Direction view = tilted(angle);
      CHECK(sampled_albedo(Bsdf::conductor_f0(Rgb(1), alpha), view, 1 << 15).x ==
            Approx(1).margin(0.01));
      CHECK(sampled_albedo(Bsdf::plastic(Rgb(1), 1.5F, alpha), view, 1 << 15).x ==
            Approx(1).margin(0.01));
    }
  }
  CHECK(sampled_albedo(Bsdf::lambert(Rgb(1)), tilted(70), 1024).x == Approx(1));
}

TEST_CASE("no material sends back more than it gets") {
  for (const float angle : {0.0F, 45.0F, 85.0F}) {
    const Imath::V3d gold = sampled_albedo(
        Bsdf::conductor({0.18F, 0.55F, 1.34F}, {3.4F, 2.2F, 1.88F}, 0.3F), tilted(angle), 4096);
    CHECK(gold.x < 1.0);
    CHECK(gold.x > gold.z);  // gold is yellow
    CHECK(sampled_albedo(Bsdf::plastic({0.5F, 0.2F, 0.1F}, 1.5F, 0.1F), tilted(angle), 4096).x <
          1.0);
  }
}

TEST_CASE("a smooth conductor reflects as Fresnel says at normal incidence") {
  const float eta = 0.2F;
  const float k = 3.0F;
  const double expected = ((eta - 1.0) * (eta - 1) + k * k) / ((eta + 1.0) * (eta + 1) + k * k);
  CHECK(sampled_albedo(Bsdf::conductor(Rgb(eta), Rgb(k), 0.01F), {0, 0, 1}, 4096).x ==
        Approx(expected).epsilon(0.01));
}

TEST_CASE("a conductor has f0 or eta and k, and is gold where it has neither") {
  const auto read = [](const std::string& keys) {
    return read_bsdf(Settings::from_text("type = 'conductor'\nalpha = 0.5\n" + keys, "a.toml"));
  };
  CHECK_THROWS_WITH(read("f0 = 0.9\neta = 1.5\n"),
                    Catch::Contains("a.toml:4:1") && Catch::Contains("either f0 or eta and k"));
  CHECK_THROWS_WITH(read("k = 2\nf0 = 0.9\n"), Catch::Contains("a.toml:3:1"));
  const Direction up(0, 0, 1);
  const Rgb gold = read("").evaluate(up, up);
  CHECK(gold == read("eta = [0.18, 0.55, 1.34]\nk = [3.4, 2.2, 1.88]\n").evaluate(up, up));
  CHECK(gold.x > 2 * gold.z);
}

TEST_CASE("sampling and evaluation agree with a plain integral") {
  for (const Bsdf& bsdf : {Bsdf::conductor({0.2F, 0.2F, 0.2F}, {3, 3, 3}, 0.4F),
                           Bsdf::plastic(Rgb(0.3F), 1.5F, 0.3F), Bsdf::lambert(Rgb(0.6F))}) {
    for (const float angle : {10.0F, 55.0F, 75.0F}) {
      CHECK(sampled_albedo(bsdf, tilted(angle), 1 << 15).x ==
            Approx(integrated_albedo(bsdf, tilted(angle), 512)).epsilon(0.01));
    }
  }
}

TEST_CASE("densities integrate to the chance of a direction above the horizon") {
  for (const Bsdf& bsdf :
       {Bsdf::conductor_f0(Rgb(0.9F), 0.3F), Bsdf::plastic(Rgb(0.3F), 1.5F, 0.4F)}) {
    const Direction view = tilted(40);
    double sum = 0;
    constexpr int n = 512;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        sum += bsdf.pdf(
            from_spherical(std::acos((i + 0.5) / n), 2 * std::numbers::pi * (j + 0.5) / n), view);
      }
    }
    int above = 0;
    for (std::uint32_t s = 0; s < 8192; ++s) {
      const auto [u, v] = sobol_point(s, 3);
      above += bsdf.sample(view, {sobol_point(s, 4)[0], u, v}).pdf > 0 ? 1 : 0;
    }
    CHECK(sum * 2 * std::numbers::pi / (n * n) == Approx(above / 8192.0).margin(0.01));
  }
}

TEST_CASE("materials are reciprocal") {
  const Direction a = from_spherical(0.4, 0.3);
  const Direction b = from_spherical(1.1, 2.0);
  for (const Bsdf& bsdf : {Bsdf::conductor({0.2F, 0.9F, 1.1F}, {3, 2, 2}, 0.4F),
                           Bsdf::plastic(Rgb(0.3F), 1.5F, 0.3F)}) {
    CHECK(bsdf.evaluate(a, b).y / a.z == Approx(bsdf.evaluate(b, a).y / b.z).epsilon(1e-4));
  }
}

TEST_CASE("nothing comes from or goes below the horizon") {
  const Bsdf bsdf = Bsdf::plastic(Rgb(0.5F), 1.5F, 0.2F);
  CHECK(bsdf.evaluate({1, 0, 0}, {0, 0, 1}) == Rgb(0, 0, 0));
  CHECK(bsdf.evaluate({0, 0, 1}, {0, 0, -1}) == Rgb(0, 0, 0));
  CHECK(bsdf.sample({1, 0, 0}, {0.5F, 0.5F, 0.5F}).pdf == 0);
}

namespace {

using Vec3d = Imath::V3d;

// The formulas as they are printed, in double: Walter et al. 2007 (33), Heitz 2014 (72, 99).
double printed_density(const Vec3d& normal, double alpha) {
  const double tangent2 = (1 - normal.z * normal.z) / (normal.z * normal.z);
  const double t = alpha * alpha + tangent2;
  return alpha * alpha / (std::numbers::pi * std::pow(normal.z, 4) * t * t);
}
double printed_lambda(const Vec3d& d, double alpha) {
  const double tangent2 = (1 - d.z * d.z) / (d.z * d.z);
  return (std::sqrt(1 + alpha * alpha * tangent2) - 1) / 2;
}

// Mean of both polarisations, from vacuum onto a complex index.
double printed_fresnel(double cosine, std::complex<double> index) {
  const std::complex<double> inside = std::sqrt(1.0 - (1 - cosine * cosine) / (index * index));
  const std::complex<double> s = (cosine - index * inside) / (cosine + index * inside);
  const std::complex<double> p = (inside - index * cosine) / (inside + index * cosine);
  return (std::norm(s) + std::norm(p)) / 2;
}

double printed_reflection(const Direction& light, const Direction& view, double alpha,
                          std::complex<double> index) {
  const Vec3d l = Vec3d(light).normalized();
  const Vec3d v = Vec3d(view).normalized();
  const Vec3d half_vector = (l + v).normalized();
  return printed_fresnel(l ^ half_vector, index) * printed_density(half_vector, alpha) /
         ((1 + printed_lambda(l, alpha) + printed_lambda(v, alpha)) * 4 * v.z);
}

}  // namespace

TEST_CASE("reflection is what the formulas of GGX and Fresnel say") {
  for (const float alpha : {0.01F, 0.1F, 0.35F, 1.0F}) {
    const Bsdf coat = Bsdf::plastic(Rgb(0), 1.5F, alpha);  // nothing under it sends light back
    for (const float view_angle : {0.0F, 30.0F, 70.0F, 89.0F}) {
      for (int k = 0; k < 40; ++k) {
        const Direction view = tilted(view_angle);
        const Direction light = k == 0 ? Direction(-view.x, -view.y, view.z)
                                       : from_spherical(radians(2.2 * k), 2.4 * k);
        INFO("alpha " << alpha << ", view " << view_angle << ", light " << k);
        CHECK(coat.evaluate(light, view).x ==
              Approx(printed_reflection(light, view, alpha, 1.5)).epsilon(2e-3).margin(1e-7));
      }
    }
  }
  // Where squares of what is small would be less than any float.
  for (const float alpha : {1e-4F, 1e-3F, 1.0F}) {
    for (const float z : {1e-9F, 1e-7F, 2e-3F}) {
      const Direction view(std::sqrt(1 - z * z), 0, z);
      const Direction light(-view.x, 0, z);
      const Bsdf coat = Bsdf::plastic(Rgb(0), 1.0001F, alpha);
      INFO("alpha " << alpha << ", z " << z);
      const float one = coat.evaluate(light, view).x;
      CHECK(std::isfinite(one));
      CHECK(one >= 0);
      const RgbLanes many = coat.evaluate(
          {all_lanes(light.x), all_lanes(light.y), all_lanes(light.z)}, coat.view_terms(view));
      CHECK(many.r[7] == Approx(one).epsilon(1e-3));
    }
  }
  // As good as a mirror, metal reflects but once.
  const Bsdf gold = Bsdf::conductor(Rgb(0.14F, 0.37F, 1.44F), Rgb(3.98F, 2.38F, 1.6F), 0.005F);
  for (const float angle : {0.0F, 30.0F, 60.0F, 80.0F, 88.0F}) {
    const Direction view = tilted(angle);
    const Direction light(-view.x, -view.y, view.z);
    INFO("theta " << angle);
    const Rgb value = gold.evaluate(light, view);
    const auto printed = [&](std::complex<double> index) {
      return Approx(printed_reflection(light, view, 0.005, index)).epsilon(2e-3);
    };
    CHECK(value.x == printed({0.14F, 3.98F}));
    CHECK(value.y == printed({0.37F, 2.38F}));
    CHECK(value.z == printed({1.44F, 1.6F}));
  }
}

TEST_CASE("sixteen lights at once get what each gets alone") {
  const std::vector<std::pair<const char*, Bsdf>> materials = {
      {"lambert", Bsdf::lambert(Rgb(0.2F, 0.5F, 0.8F))},
      {"gold", Bsdf::conductor(Rgb(0.14F, 0.37F, 1.44F), Rgb(3.98F, 2.38F, 1.6F), 0.2F)},
      {"mirror", Bsdf::conductor_f0(Rgb(0.9F, 0.8F, 0.5F), 0.001F)},
      {"plastic", Bsdf::plastic(Rgb(0.7F, 0.3F, 0.1F), 1.5F, 0.1F)}};
  for (const auto& [name, bsdf] : materials) {
    for (const float angle : {0.0F, 40.0F, 89.0F, 95.0F}) {
      const Direction view = tilted(angle);
      const Bsdf::ViewTerms terms = bsdf.view_terms(view);
      Vec3Lanes lights{};
      for (int k = 0; k < lanes; ++k) {
        // Down to below the surface; the mirror direction is among them.
        const Direction light = k == 3 ? Direction(-view.x, -view.y, view.z)
                                       : from_spherical(radians(6.5 * k), 2.4 * k);
        lights.x[k] = light.x;
        lights.y[k] = light.y;
        lights.z[k] = light.z;
      }
      const RgbLanes values = bsdf.evaluate(lights, terms);
      for (int k = 0; k < lanes; ++k) {
        const Rgb one = bsdf.evaluate({lights.x[k], lights.y[k], lights.z[k]}, view);
        INFO(name << ", view " << angle << ", light " << k);
        CHECK(values.r[k] == Approx(one.x).epsilon(1e-4).margin(1e-7));
        CHECK(values.g[k] == Approx(one.y).epsilon(1e-4).margin(1e-7));
        CHECK(values.b[k] == Approx(one.z).epsilon(1e-4).margin(1e-7));
      }
    }
  }
}
