// Small scenes and appearances for the tracer's tests.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <string>

#include "tracer/render.h"
#include "tracer/shapes/shape_registry.h"

namespace weft {

/// An appearance that is any function.
class FunctionAppearance : public Appearance {
 public:
  using Function = std::function<Rgb(const AppearanceQuery&)>;
  explicit FunctionAppearance(Function function, int texels = 1)
      : function_(std::move(function)), texels_(texels) {}
  using Appearance::evaluate;
  Rgb evaluate(Texcoord uv, Direction light, Direction view, float lod) const override {
    return light.z > 0 && view.z > 0 ? function_({uv, light, view, lod}) : Rgb(0, 0, 0);
  }
  bool has_lod() const override { return true; }
  Imath::V2i texels() const override { return {texels_, texels_}; }

 private:
  Function function_;
  int texels_;
};

inline SceneMaterial lambert(float albedo) {
  const float f = albedo / std::numbers::pi_v<float>;
  return {"lambert",
          std::make_shared<FunctionAppearance>(
              [f](const AppearanceQuery& q) { return Rgb(f, f, f) * q.light.z; }),
          nullptr,
          {1, 1}};
}

inline TriangleMesh shape_of(const std::string& toml) {
  const Settings settings = Settings::from_text(toml, "test");
  TriangleMesh mesh = make_shape(settings);
  settings.finish();
  return mesh;
}

/// One shape of one material, without lights; the camera looks down from z = 4, +y up in the
/// picture.
inline Scene scene_of(const std::string& shape, SceneMaterial material, int size = 32) {
  Scene scene;
  scene.camera = {{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 40, size, size};
  scene.shapes.push_back({"shape", shape_of(shape), 0});
  scene.materials.push_back(std::move(material));
  return scene;
}

inline EnvironmentLight constant_environment(float radiance) {
  EnvironmentLight light;
  light.radiance = Image(1, 1);
  light.radiance.set_rgb(0, 0, {radiance, radiance, radiance});
  return light;
}

inline RenderResult render_quietly(const Scene& scene, const RenderSettings& settings) {
  Progress silent;
  return render(scene, settings, silent);
}

/// Mean of a channel over the picture, in double, and the variance of that mean.
struct PictureMean {
  double mean = 0;
  double variance = 0;
};
inline PictureMean picture_mean(const RenderResult& result, int channel = 0) {
  PictureMean answer;
  const double pixels = static_cast<double>(result.image.width) * result.image.height;
  for (std::size_t i = channel; i < result.image.values.size(); i += 3) {
    answer.mean += result.image.values[i] / pixels;
    answer.variance += result.variance.values[i] / (pixels * pixels);
  }
  return answer;
}

}  // namespace weft
