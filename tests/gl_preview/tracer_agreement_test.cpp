// The preview and the path tracer draw the same picture: pixel centres, lod 0, direct light, no
// cast shadows.

#include "btf/atomic_file.h"
#include "btf/progress.h"
#include "gl_preview/headless.h"
#include "tests/gl_preview/analytic_representation.h"
#include "tests/gl_preview/codec_variants.h"
#include "tests/gl_preview/gl_or_skip.h"
#include "tests/gl_preview/procedural_btf.h"
#include "tests/gl_preview/test_scenes.h"
#include "tests/temporary_folder.h"
#include "tracer/camera.h"
#include "tracer/ray_scene.h"
#include "tracer/render.h"
#include "tracer/scene_file.h"

using namespace weft;

namespace {

constexpr double allowed = 0.005;
/// A step in depth of this share of it, from a pixel to the next, is a silhouette.
constexpr float depth_step = 0.05F;

Scene scene_of(const std::string& shape, const std::shared_ptr<const Appearance>& appearance,
               const std::string& repeat = "[6, 4]") {
  const std::string text = R"(
    camera = { type = "perspective", eye = [1, -4.5, 2.5], target = [0, 0, 0], up = [0, 0, 1], fov = 36, size = [120, 90] }
    shape = [ { type = ")" +
                           shape + R"(", material = "paint" } ]
    light = [
      { type = "point", position = [2, -2, 4], intensity = [40, 38, 30] },
      { type = "directional", direction = [-1, -1, 0.6], irradiance = [0.8, 1.0, 1.5] },
    ]
    [material.paint]
    type = "btf"
    file = "given.btf"
    repeat = )" + repeat;
  const TemporaryFolder folder;
  write_text_atomically(folder.path / "scene.toml", text);
  return read_scene(folder.path / "scene.toml",
                    [&](const std::filesystem::path&) { return appearance; });
}

/// Distance to what each pixel's centre sees; 0 for nothing.
Image depths(const Scene& scene) {
  std::vector<const TriangleMesh*> meshes;
  for (const SceneShape& shape : scene.shapes) meshes.push_back(&shape.mesh);
  const RayScene rays(meshes);
  const PerspectiveCamera camera(scene.camera);
  Image depth(camera.width(), camera.height(), 1);
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const CameraRay ray = camera.ray(x + 0.5, y + 0.5);
      const RayHit hit = rays.intersect(ray.origin, ray.direction, 0, 1e30F);
      depth.values[depth.offset(x, y)] = hit.hit() ? hit.distance : 0;
    }
  }
  return depth;
}

bool is_silhouette(const Image& depth, int x, int y) {
  const float here = depth.values[depth.offset(x, y)];
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int nx = x + dx;
      const int ny = y + dy;
      if (nx < 0 || ny < 0 || nx >= depth.width || ny >= depth.height) continue;
      const float there = depth.values[depth.offset(nx, ny)];
      if (std::abs(there - here) > depth_step * here) return true;
    }
  }
  return false;
}

/// Mean absolute difference over the mean of the reference, silhouettes apart.
double relative_difference(const Scene& scene, FixedLod lod, const Image& reference,
                           const Image& found) {
  const Image depth = depths(scene);
  double sum = 0;
  double mean_sum = 0;
  int silhouettes = 0;
  for (int y = 0; y < found.height; ++y) {
    for (int x = 0; x < found.width; ++x) {
      if (is_silhouette(depth, x, y)) {
        ++silhouettes;
        continue;
      }
      const Rgb a = reference.rgb(x, y);
      const Rgb b = found.rgb(x, y);
      sum += std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z);
      mean_sum += a.x + a.y + a.z;
    }
  }
  INFO("lod " << lod.value_or(-1));
  REQUIRE(silhouettes < found.width * found.height / 4);
  REQUIRE(mean_sum > 0);
  return sum / mean_sum;
}

double disagreement(const Scene& scene, FixedLod lod = 0.0F) {
  RenderSettings settings;
  settings.integrator = Integrator::direct;
  settings.samples_per_pixel = 1;
  settings.filter = PixelFilter::centre;
  settings.shadows = false;
  settings.lod = lod;
  Progress silent;
  const Image reference = render(scene, settings, silent).image;
  return relative_difference(scene, lod, reference, preview_headless(scene, {lod}).image);
}

}  // namespace

TEST_CASE("Frames, texcoords and lights are the path tracer's on every shape") {
  if (!gl_or_skip()) return;
  const auto appearance = std::make_shared<AnalyticRepresentation>();
  for (const char* shape : {"plane", "cube", "sphere", "torus", "seashell"}) {
    const double found = disagreement(scene_of(shape, appearance));
    INFO(shape << ": " << found);
    // Closed forms without texels: only rounding is left.
    CHECK(found < 2e-4);
  }
}

TEST_CASE("Every codec looks the same in the preview and in the path tracer", "[heavy]") {
  if (!gl_or_skip()) return;
  const auto btf = procedural_btf(8, 8, "ubo81", PixelType::half);
  for (FittedVariant& variant : fitted_variants(btf)) {
    const std::shared_ptr<const Appearance> appearance = std::move(variant.representation);
    for (const char* shape : {"cube", "torus", "seashell"}) {
      const double found = disagreement(scene_of(shape, appearance));
      INFO(variant.name << " on " << shape << ": " << found);
      CHECK(found < allowed);
    }
  }
}

TEST_CASE("Footprints from screen derivatives choose the path tracer's levels") {
  if (!gl_or_skip()) return;
  const auto btf = procedural_btf(8, 8, "regular:2x4", PixelType::half);
  for (FittedVariant& variant : fitted_variants(btf)) {
    if (!variant.representation->has_lod()) continue;
    const std::shared_ptr<const Appearance> appearance = std::move(variant.representation);
    for (const char* shape : {"cube", "torus"}) {
      const double found = disagreement(scene_of(shape, appearance, "[12, 8]"), {});
      INFO(variant.name << " on " << shape << ": " << found);
      // A 2 x 2 block of pixels shares its derivatives.
      CHECK(found < 0.02);
    }
  }
}
