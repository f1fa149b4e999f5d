// Pictures whose every pixel is known.

#include "tracer/render.h"

#include <oneapi/tbb/global_control.h>

#include "btf/error.h"
#include "tests/statistics.h"
#include "tests/tracer/test_scenes.h"
#include "tracer/bsdf_appearance.h"
#include "tracer/camera.h"

namespace weft {
namespace {

constexpr double pi = std::numbers::pi;
const std::string wide_plane = "type = 'plane'\nsize = [20, 20]";

RenderSettings exact_settings() {
  RenderSettings settings;
  settings.samples_per_pixel = 1;
  settings.filter = PixelFilter::centre;
  settings.integrator = Integrator::direct;
  return settings;
}

RenderSettings settings_with(int spp, int bounces) {
  RenderSettings settings;
  settings.samples_per_pixel = spp;
  settings.max_bounces = bounces;
  return settings;
}

double largest_relative_error(const Image& image,
                              const std::function<double(int x, int y)>& expected) {
  double worst = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      worst = std::max(worst, std::abs(image.rgb(x, y).x / expected(x, y) - 1));
    }
  }
  return worst;
}

TEST_CASE("A Lambert plane under directional lights", "[render]") {
  Scene scene = scene_of(wide_plane, lambert(0.5F));
  scene.directional_lights.push_back({from_spherical(radians(60.0), 1), {3, 3, 3}});
  scene.directional_lights.push_back({from_spherical(radians(20.0), 4), {2, 2, 2}});
  scene.directional_lights.push_back({from_spherical(radians(120.0), 4), {9, 9, 9}});  // from below
  const double expected = 0.5 / pi * (3 * std::cos(radians(60.0)) + 2 * std::cos(radians(20.0)));
  const RenderResult result = render_quietly(scene, exact_settings());
  CHECK(largest_relative_error(result.image, [&](int, int) { return expected; }) < 1e-5);
  CHECK(result.statistics.samples == 32 * 32);
  CHECK(result.statistics.rays == 3 * 32 * 32);
  CHECK(result.statistics.evaluations == 2 * 32 * 32);
}

TEST_CASE("A Lambert plane under a point light", "[render]") {
  Scene scene = scene_of(wide_plane, lambert(1));
  const Vec3 light(0.7F, -0.4F, 1.5F);
  scene.point_lights.push_back({light, {5, 5, 5}});
  const PerspectiveCamera camera(scene.camera);
  const RenderResult result = render_quietly(scene, exact_settings());
  const double worst = largest_relative_error(result.image, [&](int x, int y) {
    const CameraRay ray = camera.ray(x + 0.5, y + 0.5);
    const Vec3 way = light - (ray.origin - ray.direction * (ray.origin.z / ray.direction.z));
    return 5 / pi * way.z / std::pow(way.length(), 3);
  });
  CHECK(worst < 1e-5);
}

TEST_CASE("The local frame is (dP/du, n x dP/du, n), not flipped at the back", "[render]") {
  const SceneMaterial light_direction{
      "l",
      std::make_shared<FunctionAppearance>([](const AppearanceQuery& q) {
        return Rgb(q.light.x, q.light.y, q.light.z) * 0.25F + Rgb(0.5F, 0.5F, 0.5F);
      }),
      nullptr,
      {1, 1}};
  Scene scene = scene_of(wide_plane + "\nrotate = [0, 0, 90]", light_direction);
  const Direction light = from_spherical(0.9, 0.3);
  scene.directional_lights.push_back({light, {1, 1, 1}});
  // Turned by 90 degrees: dP/du = +y, n x dP/du = -x.
  const Rgb seen = render_quietly(scene, exact_settings()).image.rgb(16, 16);
  CHECK(seen.x == Approx(0.5 + 0.25 * light.y));
  CHECK(seen.y == Approx(0.5 - 0.25 * light.x));
  CHECK(seen.z == Approx(0.5 + 0.25 * light.z));
  scene.camera.eye.z = -4;
  scene.directional_lights[0].direction.z *= -1;
  CHECK(picture_mean(render_quietly(scene, exact_settings())).mean == 0);
}

TEST_CASE("uv repeat as the material says", "[render]") {
  const SceneMaterial texture{"uv",
                              std::make_shared<FunctionAppearance>(
                                  [](const AppearanceQuery& q) { return Rgb(q.uv.x, q.uv.y, 0); }),
                              nullptr,
                              {3, 5}};
  Scene scene = scene_of("type = 'plane'\nsize = [4, 4]", texture);
  scene.directional_lights.push_back({{0, 0, 1}, {1, 1, 1}});
  const PerspectiveCamera camera(scene.camera);
  const RenderResult result = render_quietly(scene, exact_settings());
  for (const auto& [x, y] : {std::array{3, 7}, std::array{16, 16}, std::array{28, 5}}) {
    const CameraRay ray = camera.ray(x + 0.5, y + 0.5);
    const Vec3 p = ray.origin - ray.direction * (ray.origin.z / ray.direction.z);
    CHECK(result.image.rgb(x, y).x == Approx(3 * (p.x + 2) / 4).epsilon(1e-5));
    CHECK(result.image.rgb(x, y).y == Approx(5 * (p.y + 2) / 4).epsilon(1e-5));
  }
}

TEST_CASE("Shadows fall, unless they are switched off", "[render]") {
  Scene scene = scene_of(wide_plane, lambert(1), 33);
  scene.shapes.push_back(
      {"ball", shape_of("type = 'sphere'\nradius = 0.3\ntranslate = [1, 0, 1]"), 0});
  scene.directional_lights.push_back(
      {Vec3(1, 0, 1).normalized(), {1, 1, 1}});  // the shadow is at the origin
  RenderSettings settings = exact_settings();
  CHECK(render_quietly(scene, settings).image.rgb(16, 16).x == 0);
  CHECK(render_quietly(scene, settings).image.rgb(2, 16).x == Approx(std::sqrt(0.5) / pi));
  settings.shadows = false;
  CHECK(render_quietly(scene, settings).image.rgb(16, 16).x == Approx(std::sqrt(0.5) / pi));
  // A light nearer than what is behind it is not shadowed by that.
  scene.directional_lights.clear();
  scene.point_lights.push_back({{0.5F, 0, 0.5F}, {1, 1, 1}});
  settings.shadows = true;
  CHECK(render_quietly(scene, settings).image.rgb(16, 16).x ==
        Approx(0.5 / pi / std::pow(0.5, 1.5)));
}

TEST_CASE("A surface does not shadow itself, at any scale and place", "[render]") {
  const auto [scale, place] = GENERATE(std::pair{1.0F, 0.0F}, std::pair{1e-4F, 0.0F},
                                       std::pair{1e4F, 0.0F}, std::pair{1.0F, 300.0F});
  CAPTURE(scale, place);
  Scene scene = scene_of("type = 'sphere'\nradius = " + std::to_string(scale) + "\ntranslate = [" +
                             std::to_string(place) + ", 0, 0]",
                         lambert(1), 96);
  scene.camera.eye = Vec3(place, 0, 4 * scale);
  scene.camera.target = Vec3(place, 0, 0);
  const Direction light = Vec3(1, 1, 2).normalized();
  scene.directional_lights.push_back({light, {1, 1, 1}});
  RenderSettings settings = exact_settings();
  const Image shadowed = render_quietly(scene, settings).image;
  settings.shadows = false;
  const Image lit = render_quietly(scene, settings).image;
  int dark = 0;
  for (std::size_t i = 0; i < lit.values.size(); ++i) {
    if (lit.values[i] > 0.03 / pi && shadowed.values[i] != lit.values[i]) ++dark;
  }
  CHECK(dark == 0);
}

TEST_CASE("White furnace: what is white in a white world cannot be seen", "[render]") {
  const std::string shape = GENERATE("sphere", "torus", "cube", "seashell");
  CAPTURE(shape);
  Scene scene = scene_of("type = '" + shape + "'", lambert(1), 24);
  if (shape == "seashell")
    scene.shapes[0].mesh =
        shape_of("type = 'seashell'\ntranslate = [0, 0, 2]\nrotate = [70, 0, 0]");
  scene.camera.eye = {0, -3, 3};
  scene.environments.push_back(constant_environment(2));
  const RenderResult result =
      render_quietly(scene, settings_with(64, RenderSettings::unlimited_bounces));
  const PictureMean mean = picture_mean(result);
  CHECK(mean.mean == Approx(2).epsilon(2e-3));
  CHECK(statistics::z_test(mean.mean, 2, mean.variance + std::pow(2 * 2e-4, 2)) > 1e-3);
  CHECK(result.statistics.invalid.not_finite == 0);
}

TEST_CASE("Without bounces a torus' hole is darker, and each bounce adds", "[render]") {
  Scene scene = scene_of("type = 'torus'", lambert(1), 24);
  scene.environments.push_back(constant_environment(1));
  double before = 0;
  for (const int bounces : {0, 1, 4}) {
    const double mean = picture_mean(render_quietly(scene, settings_with(64, bounces))).mean;
    CHECK(mean > before + 0.002);
    CHECK(mean < 1);
    before = mean;
  }
}

TEST_CASE("One bounce between two parallel planes", "[render]") {
  // A lamp between floor and ceiling; the direct light on the ceiling comes back once to the
  // floor's centre. B1(0) = rho^2 I / pi^2 integral of h'/(h'^2+r^2)^1.5 h^2/(h^2+r^2)^2 2 pi r dr,
  // h = 1 above, h' = 0.5 below it.
  Scene scene = scene_of("type = 'plane'\nsize = [400, 400]", lambert(0.8F), 1);
  scene.shapes.push_back(
      {"ceiling",
       shape_of("type = 'plane'\nsize = [400, 400]\nrotate = [180, 0, 0]\ntranslate = [0, 0, 1]"),
       0});
  scene.camera.eye = {0, 0, 0.9F};
  scene.point_lights.push_back({{0, 0, 0.5F}, {1, 1, 1}});
  double integral = 0;
  constexpr double dr = 1e-3;
  for (double r = dr / 2; r < 100; r += dr) {
    integral += 0.5 / std::pow(0.25 + r * r, 1.5) / std::pow(1 + r * r, 2) * 2 * pi * r * dr;
  }
  const double expected = 0.8 / pi * 4 + 0.64 / (pi * pi) * integral;
  RenderSettings settings = settings_with(1 << 16, 1);
  settings.filter = PixelFilter::centre;
  const RenderResult result = render_quietly(scene, settings);
  CHECK(result.image.rgb(0, 0).x == Approx(expected).epsilon(1e-3));
}

/// Irradiance over pi on the plane z = 0 from a picture, by the exact integral of the cosine over
/// each pixel.
double exact_radiosity(const EnvironmentLight& light) {
  const Image& image = light.radiance;
  double sum = 0;
  for (int y = 0; y < image.height / 2; ++y) {
    const double a = pi * y / image.height, b = pi * (y + 1) / image.height;
    const double weight =
        (std::pow(std::sin(b), 2) - std::pow(std::sin(a), 2)) / 2 * 2 * pi / image.width;
    for (int x = 0; x < image.width; ++x) sum += image.rgb(x, y).x * weight;
  }
  return sum / pi;
}

TEST_CASE("An environment lights a plane by its exact integral", "[render]") {
  Scene scene = scene_of(wide_plane, lambert(1), 24);
  EnvironmentLight light;
  light.radiance = Image(64, 32);
  const bool sun = GENERATE(false, true);
  for (int y = 0; y < 32 && !sun; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float value = std::exp(std::sin(0.2F * x) * 2) * (1 + y);
      light.radiance.set_rgb(x, y, {value, value, value});
    }
  }
  if (sun) light.radiance.set_rgb(20, 9, {1e5F, 1e5F, 1e5F});
  const double expected = exact_radiosity(light);
  scene.environments.push_back(light);
  // Sampled in both ways, and by the environment alone: the same, and neither biased.
  for (const bool shadows : {true, false}) {
    RenderSettings settings = settings_with(16, 0);
    settings.shadows = shadows;
    const RenderResult result = render_quietly(scene, settings);
    const PictureMean mean = picture_mean(result);
    CHECK(mean.mean == Approx(expected).epsilon(0.01));
    CHECK(statistics::z_test(mean.mean, expected, mean.variance) > 1e-3);
    // A pixel of 16 samples is good to 2 % under the sun: it is found by every sample.
    if (sun) CHECK(std::sqrt(mean.variance * 24 * 24) < 0.02 * expected);
  }
}

TEST_CASE("Where the camera meets nothing it sees the environment", "[render]") {
  Scene scene = scene_of("type = 'sphere'\ntranslate = [0, 0, 100]\nradius = 0.1", lambert(1), 9);
  EnvironmentLight light = constant_environment(1);
  light.radiance = Image(4, 2);
  light.radiance.set_rgb(1, 1, {7, 0, 0});  // phi in (0, 90) degrees, below
  scene.environments.push_back(light);
  scene.camera = {{0, 0, 0}, Vec3(1, 1, -0.5F), {0, 0, 1}, 5, 9, 9};
  CHECK(picture_mean(render_quietly(scene, exact_settings())).mean == Approx(7));
}

TEST_CASE("The same bytes for any number of threads, others for another seed", "[render]") {
  Scene scene = scene_of("type = 'torus'", lambert(0.7F), 50);
  scene.environments.push_back(constant_environment(1));
  scene.point_lights.push_back({{2, 2, 2}, {3, 3, 3}});
  RenderSettings settings = settings_with(20, 3);
  std::vector<Image> pictures;
  for (const int threads : {1, 2, 5}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                            threads);
    pictures.push_back(render_quietly(scene, settings).image);
  }
  CHECK(pictures[0].values == pictures[1].values);
  CHECK(pictures[0].values == pictures[2].values);
  settings.seed = 1;
  CHECK(render_quietly(scene, settings).image.values != pictures[0].values);
}

TEST_CASE("Pictures of few samples are those of many, on average", "[render]") {
  Scene scene = scene_of("type = 'torus'", lambert(0.7F), 16);
  EnvironmentLight light = constant_environment(1);
  light.radiance = Image(8, 4);
  for (int i = 0; i < 32; ++i) light.radiance.set_rgb(i % 8, i / 8, {1.0F + i, 1, 1});
  scene.environments.push_back(light);
  const double reference = picture_mean(render_quietly(scene, settings_with(2048, 2))).mean;
  std::vector<double> samples;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    RenderSettings settings = settings_with(4, 2);
    settings.seed = seed;
    samples.push_back(picture_mean(render_quietly(scene, settings)).mean);
  }
  CHECK(statistics::t_test(samples, reference) > 1e-3);
}

TEST_CASE("A BSDF's own sampling changes the noise, not the picture", "[render]") {
  const Bsdf bsdf = GENERATE(Bsdf::conductor_f0({0.9F, 0.7F, 0.5F}, 0.2F),
                             Bsdf::plastic({0.6F, 0.3F, 0.1F}, 1.5F, 0.3F));
  SceneMaterial material{"glossy", std::make_shared<BsdfAppearance>(bsdf), nullptr, {1, 1}};
  Scene scene = scene_of("type = 'torus'", material, 24);
  EnvironmentLight light;
  light.radiance = Image(8, 4);
  for (int i = 0; i < 32; ++i) light.radiance.set_rgb(i % 8, i / 8, {1.0F + i % 5, 1, 1});
  scene.environments.push_back(light);
  const auto pictures = [&] {
    std::vector<double> means;
    double variance = 0;
    for (std::uint64_t seed = 0; seed < 16; ++seed) {
      RenderSettings settings = settings_with(16, 3);
      settings.seed = seed;
      const PictureMean mean = picture_mean(render_quietly(scene, settings));
      means.push_back(mean.mean);
      variance += mean.variance;
    }
    return std::pair(means, variance);
  };
  const auto [by_cosine, cosine_variance] = pictures();
  scene.materials[0].bsdf = std::make_shared<Bsdf>(bsdf);
  const auto [by_bsdf, bsdf_variance] = pictures();
  // Paired by seed: the differences have mean zero.
  std::vector<double> differences;
  for (std::size_t i = 0; i < by_bsdf.size(); ++i) differences.push_back(by_bsdf[i] - by_cosine[i]);
  CHECK(statistics::t_test(differences, 0) > 1e-3);
  CHECK(by_bsdf[0] == Approx(by_cosine[0]).epsilon(0.02));
  CHECK(bsdf_variance < cosine_variance);
}

SceneMaterial shows_lod() {
  return {"lod",
          std::make_shared<FunctionAppearance>(
              [](const AppearanceQuery& q) { return Rgb(q.lod, q.lod, q.lod); }, 64),
          nullptr,
          {2, 2}};
}

TEST_CASE("lod is log2 of a pixel's footprint in texels, one more at twice the distance",
          "[render]") {
  Scene scene = scene_of("type = 'plane'\nsize = [40, 40]", shows_lod(), 101);
  scene.directional_lights.push_back({{0, 0, 1}, {1, 1, 1}});
  const auto seen = [&](float distance) {
    scene.camera.eye.z = distance;
    return render_quietly(scene, exact_settings()).image.rgb(50, 50).x;
  };
  const auto footprint = [](double distance) {
    return 2 * distance * std::tan(radians(20.0)) / 101 * (2 * 64 / 40.0);
  };
  CHECK(seen(100) == Approx(std::log2(footprint(100))).epsilon(1e-4));
  CHECK(seen(200) - seen(100) == Approx(1).epsilon(1e-4));
  CHECK(seen(1) == 0);  // magnified: the finest level
  // Seen at 60 degrees the footprint is twice as long as wide, and further off.
  scene.camera.eye = {100 * std::sin(radians(60.0F)), 0, 100 * std::cos(radians(60.0F))};
  CHECK(render_quietly(scene, exact_settings()).image.rgb(50, 50).x ==
        Approx(std::log2(2 * footprint(100))).epsilon(1e-3));
  RenderSettings fixed = exact_settings();
  fixed.lod = 2.5F;
  CHECK(render_quietly(scene, fixed).image.rgb(50, 50).x == 2.5F);
}

TEST_CASE("An appearance's invalid answers are counted with their place", "[render]") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const SceneMaterial broken{"broken",
                             std::make_shared<FunctionAppearance>([=](const AppearanceQuery& q) {
                               return q.uv.x < 0.5F ? Rgb(nan, 0, 0) : Rgb(-1, -1, -1);
                             }),
                             nullptr,
                             {1, 1}};
  Scene scene = scene_of(wide_plane, broken);
  const bool lamp = GENERATE(true, false);  // seen as direct light, and in a bounce alone
  if (lamp) scene.directional_lights.push_back({{0, 0, 1}, {1, 1, 1}});
  const RenderStatistics statistics = render_quietly(scene, settings_with(4, 1)).statistics;
  CHECK(statistics.invalid.not_finite == 32 * 16 * 4);
  REQUIRE(statistics.invalid.first);
  CHECK(*statistics.invalid.first == std::array{0, 0});
  if (lamp) CHECK(statistics.invalid.negative == 32 * 16 * 4);
}

TEST_CASE("Settings and scenes that cannot be are refused", "[render]") {
  Scene scene = scene_of(wide_plane, lambert(1));
  CHECK_THROWS_WITH(render_quietly(scene, settings_with(0, 1)), Catch::Contains("--spp"));
  CHECK_THROWS_WITH(render_quietly(scene, settings_with(1, -1)), Catch::Contains("--max-bounces"));
  scene.shapes[0].mesh.tangents.clear();
  CHECK_THROWS_WITH(render_quietly(scene, settings_with(1, 1)), Catch::Contains("tangents"));
  scene.shapes.clear();
  CHECK_THROWS_AS(render_quietly(scene, settings_with(1, 1)), Error);
}

}  // namespace
}  // namespace weft
