#include "tracer/scene_file.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "btf/error.h"
#include "images/image_file.h"
#include "tracer/bsdf.h"
#include "tracer/bsdf_appearance.h"
#include "tracer/camera.h"
#include "tracer/lights/environment_radiance.h"
#include "tracer/shapes/shape_registry.h"

namespace weft {
namespace {

Camera read_camera(const Settings& settings) {
  settings.choice("type", {"perspective"});
  Camera camera;
  camera.eye = settings.vec3("eye", camera.eye);
  camera.target = settings.vec3("target", camera.target);
  camera.up = settings.vec3("up", camera.up);
  camera.fov = static_cast<float>(settings.number("fov", camera.fov, 0.001, 179.9));
  if (settings.has("size")) {
    const std::vector<double> size = settings.numbers("size");
    const auto valid = [](double n) { return n >= 1 && n <= 65536 && n == std::floor(n); };
    if (size.size() != 2 || !valid(size[0]) || !valid(size[1])) {
      throw bad_input(settings.where("size"),
                      "size is not [width, height] in pixels, each 1 to 65536");
    }
    camera.width = static_cast<int>(size[0]);
    camera.height = static_cast<int>(size[1]);
  }
  try {
    PerspectiveCamera check(camera);
  } catch (const Error& error) {
    throw bad_input(settings.where(), error.what());
  }
  return camera;
}

void read_point_light(const Settings& settings, Scene& scene) {
  scene.point_lights.push_back({settings.vec3("position"), settings.rgb("intensity", {1, 1, 1})});
}

void read_directional_light(const Settings& settings, Scene& scene) {
  const Vec3 direction = settings.vec3("direction");
  if (direction.length() == 0) {
    throw bad_input(settings.where("direction"), "the direction has no length",
                    "give a vector towards the light");
  }
  scene.directional_lights.push_back(
      {direction.normalized(), settings.rgb("irradiance", {1, 1, 1})});
}

/// Three channels of any picture: grey is repeated, alpha left out.
Image as_rgb(const Image& image) {
  Image rgb(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float grey = image.values[image.offset(x, y)];
      rgb.set_rgb(x, y, image.channels >= 3 ? image.rgb(x, y) : Rgb(grey, grey, grey));
    }
  }
  return rgb;
}

/// A picture (`file`, times `scale`), or the same `radiance` from everywhere. Checked here, so that
/// every renderer takes and refuses the same files.
void read_environment_light(const Settings& settings, Scene& scene) {
  EnvironmentLight light;
  if (settings.has("file") == settings.has("radiance")) {
    throw bad_input(settings.where(),
                    "an environment needs either `file` (a lat-long picture) or `radiance`");
  }
  if (settings.has("file")) {
    const std::filesystem::path file = settings.existing_path("file");
    light.name = file.string();
    light.radiance = as_rgb(read_image(file, Encoding::colour));
    light.negative_values = clear_negative_values(light.radiance);
    const auto scale = static_cast<float>(settings.number("scale", 1, 0, 1e12));
    for (float& value : light.radiance.values) value *= scale;
  } else {
    light.radiance = Image(1, 1);
    light.radiance.set_rgb(0, 0, settings.rgb("radiance", {1, 1, 1}));
  }
  check_radiance(light);
  light.rotate = static_cast<float>(radians(settings.number("rotate", 0)));
  scene.environments.push_back(std::move(light));
}

struct LightType {
  const char* name;
  void (*read)(const Settings&, Scene&);
};
constexpr LightType light_types[] = {
    {"point", read_point_light},
    {"directional", read_directional_light},
    {"environment", read_environment_light},
};

void read_light(const Settings& settings, Scene& scene) {
  std::vector<std::string> names;
  for (const LightType& type : light_types) names.emplace_back(type.name);
  settings.text("type");  // there is no light by default
  const std::string name = settings.choice("type", names);
  for (const LightType& type : light_types) {
    if (name == type.name) type.read(settings, scene);
  }
}

using Paths = std::map<std::string, std::filesystem::path>;

SceneMaterial read_material(const std::string& name, const Settings& settings,
                            const OpenAppearance& open, const Paths& btf_paths) {
  SceneMaterial material;
  material.name = name;
  settings.text("type");  // there is no material by default
  if (settings.choice("type", {"btf", "lambert", "conductor", "plastic"}) != "btf") {
    material.bsdf = std::make_shared<Bsdf>(read_bsdf(settings));
    material.appearance = std::make_shared<BsdfAppearance>(*material.bsdf);
    return material;
  }
  material.repeat = settings.vec2("repeat", {1, 1});
  if (!(material.repeat.x > 0 && material.repeat.y > 0)) {
    throw bad_input(settings.where("repeat"), "repeat is not above 0");
  }
  auto replacement = btf_paths.find(name);
  if (replacement == btf_paths.end()) replacement = btf_paths.find("");
  // The file's own path is asked for even where it is replaced: the key is known.
  const std::filesystem::path own =
      settings.has("file") || replacement == btf_paths.end() ? settings.path("file") : "";
  material.appearance = open(replacement == btf_paths.end() ? own : replacement->second);
  return material;
}

std::vector<std::string> names_of(const std::vector<SceneMaterial>& materials) {
  std::vector<std::string> names;
  for (const SceneMaterial& material : materials) names.push_back(material.name);
  return names;
}

void check_replacements(const Paths& btf_paths, const Settings& materials) {
  std::vector<std::string> btf_names;
  for (const std::string& name : materials.keys()) {
    if (materials.table(name).text("type", "") == "btf") btf_names.push_back(name);
  }
  for (const auto& [name, path] : btf_paths) {
    if (name.empty() && btf_names.empty()) {
      throw bad_input("--btf " + path.string(), "the scene has no material of type \"btf\"");
    }
    if (!name.empty() && std::find(btf_names.begin(), btf_names.end(), name) == btf_names.end()) {
      throw bad_input("--btf " + name + "=" + path.string(),
                      fmt::format("the scene has no btf material '{}'", name),
                      fmt::format("its btf materials: {}", fmt::join(btf_names, ", ")));
    }
  }
}

/// Meshes from files may lack texture coordinates; only a material that is the same everywhere does
/// without.
void complete_texcoords(SceneShape& shape, const SceneMaterial& material,
                        const Settings& settings) {
  if (!shape.mesh.texcoords.empty()) return;
  const Imath::V2i texels = material.appearance->texels();
  if (texels.x > 1 || texels.y > 1) {
    throw bad_input(settings.where(), "the mesh has no texture coordinates, and its material '" +
                                          material.name + "' needs them");
  }
  shape.mesh.texcoords.assign(shape.mesh.positions.size(), Vec2(0, 0));
}

SceneShape read_shape(const Settings& settings, std::size_t index,
                      const std::vector<SceneMaterial>& materials) {
  SceneShape shape;
  shape.name = settings.text("name", fmt::format("shape {}", index));
  shape.mesh = make_shape(settings);
  const std::string name = settings.text("material");
  const auto found =
      std::find_if(materials.begin(), materials.end(),
                   [&](const SceneMaterial& material) { return material.name == name; });
  if (found == materials.end()) {
    throw bad_input(settings.where("material"), fmt::format("there is no material '{}'", name),
                    fmt::format("materials: {}", fmt::join(names_of(materials), ", ")));
  }
  shape.material = found - materials.begin();
  complete_texcoords(shape, *found, settings);
  return shape;
}

}  // namespace

Scene read_scene(const std::filesystem::path& path, const OpenAppearance& open,
                 const Paths& btf_paths, const std::vector<std::string>& overrides) {
  const Settings settings = Settings::from_file(path, overrides);
  Scene scene;
  scene.camera = read_camera(settings.table("camera"));
  for (const Settings& light : settings.tables("light")) read_light(light, scene);
  const Settings materials = settings.table("material");
  check_replacements(btf_paths, materials);
  for (const std::string& name : materials.keys()) {
    scene.materials.push_back(read_material(name, materials.table(name), open, btf_paths));
  }
  for (const Settings& shape : settings.tables("shape")) {
    scene.shapes.push_back(read_shape(shape, scene.shapes.size(), scene.materials));
  }
  settings.finish();
  if (scene.shapes.empty())
    throw bad_input(path.string(), "the scene has no shape", "add shape = [ { type = … } ]");
  return scene;
}

}  // namespace weft
