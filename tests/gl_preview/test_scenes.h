// Small scenes made in memory.
#pragma once

#include <memory>

#include "tests/gl_preview/plain_appearance.h"
#include "tracer/scene.h"

/// A quad from (-1, -1) to (1, 1) at z = 0 that looks up, uv over [0, 1]^2.
inline weft::SceneShape unit_quad(std::size_t material = 0) {
  weft::SceneShape shape;
  shape.name = "quad";
  shape.material = material;
  for (const weft::Vec2& uv :
       {weft::Vec2(0, 0), weft::Vec2(1, 0), weft::Vec2(1, 1), weft::Vec2(0, 1)}) {
    shape.mesh.positions.emplace_back(2 * uv.x - 1, 2 * uv.y - 1, 0.0F);
    shape.mesh.texcoords.push_back(uv);
  }
  shape.mesh.normals.assign(4, {0, 0, 1});
  shape.mesh.tangents.assign(4, {1, 0, 0});
  shape.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return shape;
}

/// The quad seen from a slant, 64 x 48 pixels, painted with `appearance`; no lights yet.
inline weft::Scene quad_scene(std::shared_ptr<const weft::Appearance> appearance) {
  weft::Scene scene;
  scene.camera.eye = {0.5F, -2, 2};
  scene.camera.target = {0, 0, 0};
  scene.camera.width = 64;
  scene.camera.height = 48;
  scene.shapes = {unit_quad()};
  scene.materials = {{.name = "paint", .appearance = std::move(appearance), .bsdf = nullptr}};
  return scene;
}
