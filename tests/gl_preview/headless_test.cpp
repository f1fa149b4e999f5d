// Pictures whose every pixel is known in closed form.

#include "gl_preview/headless.h"

#include "btf/error.h"
#include "tests/gl_preview/gl_or_skip.h"
#include "tests/gl_preview/test_scenes.h"

using namespace weft;

namespace {

/// Where the ray through a pixel's centre meets z = 0, and whether that is on the quad.
struct QuadHit {
  Vec3 position;
  bool on_quad;
};

QuadHit quad_hit(const Camera& camera, int x, int y) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  const Vec3 right = forward.cross(camera.up).normalized();
  const Vec3 up = right.cross(forward);
  const float half = std::tan(radians(camera.fov) / 2);
  const float s = (2 * (x + 0.5F) / camera.width - 1) * half * camera.width / camera.height;
  const float t = (1 - 2 * (y + 0.5F) / camera.height) * half;
  const Vec3 direction = forward + s * right + t * up;
  const Vec3 p = camera.eye - direction * (camera.eye.z / direction.z);
  return {p, direction.z < 0 && std::abs(p.x) < 1 && std::abs(p.y) < 1};
}

}  // namespace

TEST_CASE("A lit Lambert quad has the radiance of the formula at every pixel") {
  if (!gl_or_skip()) return;
  const Rgb albedo(0.9F, 0.5F, 0.2F);
  Scene scene = quad_scene(std::make_shared<LambertAppearance>(albedo));
  scene.point_lights = {{{0.5F, 0.5F, 1.5F}, {3, 4, 5}}};
  scene.directional_lights = {{Vec3(1, 2, 2) / 3, {1, 2, 0.5F}}};
  const HeadlessPicture picture = preview_headless(scene, {});
  REQUIRE(picture.image.width == 64);
  REQUIRE(picture.image.height == 48);
  int seen = 0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const QuadHit hit = quad_hit(scene.camera, x, y);
      Rgb expected(0, 0, 0);
      if (hit.on_quad) {
        const Vec3 d = scene.point_lights[0].position - hit.position;
        const float from_point = d.z / (d.length() * d.length2());
        for (int c = 0; c < 3; ++c) {
          expected[c] = albedo[c] / std::numbers::pi_v<float> *
                        (scene.point_lights[0].intensity[c] * from_point +
                         scene.directional_lights[0].irradiance[c] * (2.0F / 3.0F));
        }
        ++seen;
      }
      INFO("pixel " << x << ", " << y);
      REQUIRE(picture.image.rgb(x, y).equalWithAbsError(expected, 2e-5F));
    }
  }
  CHECK(seen > 500);
}

TEST_CASE("The back of a surface is black, and hides what is behind it") {
  if (!gl_or_skip()) return;
  Scene scene = quad_scene(std::make_shared<LambertAppearance>(Rgb(1, 1, 1)));
  scene.directional_lights = {{{0, 0, 1}, {1, 1, 1}}, {{0, 0, -1}, {1, 1, 1}}};
  SceneShape below = unit_quad();
  for (Vec3& p : below.mesh.positions) p.z = -0.5F;
  for (Vec3& n : below.mesh.normals) n.z = -1;
  scene.shapes.push_back(below);
  scene.camera.eye.z = -2;  // sees the lower quad's front, and a rim of the upper one's back
  for (const bool swapped : {false, true}) {
    if (swapped) std::swap(scene.shapes[0], scene.shapes[1]);
    const Image image = preview_headless(scene, {}).image;
    CHECK(image.rgb(32, 24).x == Approx(1 / std::numbers::pi).epsilon(1e-4));
  }
  scene.shapes.erase(scene.shapes.begin());
  const Image back = preview_headless(scene, {}).image;
  CHECK(*std::max_element(back.values.begin(), back.values.end()) == 0);
}

TEST_CASE("Each shape has its own material, and a shared appearance is uploaded once") {
  if (!gl_or_skip()) return;
  const auto red = std::make_shared<LambertAppearance>(Rgb(1, 0, 0));
  Scene scene = quad_scene(red);
  scene.directional_lights = {{{0, 0, 1}, {1, 1, 1}}};
  const std::size_t bytes = preview_headless(scene, {}).bytes;
  scene.materials.push_back({"same", red, nullptr, {2, 2}});
  scene.materials.push_back(
      {"green", std::make_shared<LambertAppearance>(Rgb(0, 1, 0)), nullptr, {1, 1}});
  scene.shapes.push_back(unit_quad(2));
  for (Vec3& p : scene.shapes[0].mesh.positions) p.x = std::min(p.x, 0.0F);
  for (Vec3& p : scene.shapes[1].mesh.positions) p.x = std::max(p.x, 0.0F);
  const HeadlessPicture picture = preview_headless(scene, {});
  CHECK(picture.bytes == 2 * bytes);
  const auto colour_at = [&](float world_x) {
    for (int x = 0; x < 64; ++x) {
      const QuadHit hit = quad_hit(scene.camera, x, 24);
      if (hit.on_quad && std::abs(hit.position.x - world_x) < 0.05F)
        return picture.image.rgb(x, 24);
    }
    return Rgb(-1, -1, -1);
  };
  CHECK(colour_at(-0.5F).x > 0.3F);
  CHECK(colour_at(-0.5F).y == 0);
  CHECK(colour_at(0.5F).y > 0.3F);
  CHECK(colour_at(0.5F).x == 0);
}

TEST_CASE("What cannot be drawn is named") {
  if (!gl_or_skip()) return;
  Scene scene = quad_scene(std::make_shared<LambertAppearance>(Rgb(1, 1, 1)));
  scene.camera.width = 1 << 20;
  CHECK_THROWS_WITH(preview_headless(scene, {}), Catch::Contains("1048576 x 48"));
  scene.camera.width = 64;
  scene.shapes[0].mesh.tangents.pop_back();
  CHECK_THROWS_WITH(preview_headless(scene, {}), Catch::Contains("shape quad"));
}

TEST_CASE("Timed frames are told") {
  if (!gl_or_skip()) return;
  Scene scene = quad_scene(std::make_shared<LambertAppearance>(Rgb(1, 1, 1)));
  const HeadlessPicture picture = preview_headless(scene, {0.0F, 2});
  CHECK(picture.best_ms > 0);
  CHECK(picture.ms_per_frame >= picture.best_ms);
  CHECK(picture.renderer.size() > 3);
}
