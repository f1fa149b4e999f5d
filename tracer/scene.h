// A scene to render, as plain data: what the scene file says, with its meshes made and its BTFs
// opened.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "btf/appearance.h"
#include "images/image.h"
#include "tracer/bsdf.h"
#include "tracer/triangle_mesh.h"

namespace weft {

/// `fov` is the vertical full angle in degrees. Row 0 of the picture is the top.
struct Camera {
  Vec3 eye{0, -4, 2};
  Vec3 target{0, 0, 0};
  Vec3 up{0, 0, 1};
  float fov = 40;
  int width = 800;
  int height = 800;
};

/// Radiant intensity in W/sr.
struct PointLight {
  Vec3 position;
  Rgb intensity;
};

/// Irradiance on a surface perpendicular to it, in W/m^2; `direction` towards the light, unit.
struct DirectionalLight {
  Direction direction;
  Rgb irradiance;
};

/// Lat-long radiance: z up, row 0 the zenith, phi = pi - 2 pi (x+.5)/W, turned by `rotate` radians
/// about +z.
struct EnvironmentLight {
  Image radiance;
  float rotate = 0;
  std::string name = "environment";  ///< as errors call it: its file
  std::int64_t negative_values = 0;  ///< of the file's, which are 0 in `radiance`
};

struct SceneMaterial {
  std::string name;
  std::shared_ptr<const Appearance> appearance;
  /// What the appearance is, where it is a plain BSDF: draws directions for it. Null: drawn by the
  /// cosine.
  std::shared_ptr<const Bsdf> bsdf;
  Vec2 repeat{1, 1};  ///< uv of the mesh are multiplied by this
};

/// A mesh in world space with normals, texcoords and tangents at every vertex.
struct SceneShape {
  std::string name;
  TriangleMesh mesh;
  std::size_t material = 0;
};

struct Scene {
  Camera camera;
  std::vector<SceneShape> shapes;
  std::vector<SceneMaterial> materials;
  std::vector<PointLight> point_lights;
  std::vector<DirectionalLight> directional_lights;
  std::vector<EnvironmentLight> environments;
};

}  // namespace weft
