// The GLSL around a representation's btf_evaluate: camera, what a pixel sees, local frame, sum over
// lights.
#pragma once

#include <string>

namespace weft {

/// Uniform locations of the shaders below.
namespace uniform {
constexpr int eye = 0;
// Of the geometry pass.
constexpr int view_rows = 1;  // an array of 3
constexpr int projection = 4;
constexpr int repeat = 5;
constexpr int texels = 6;
constexpr int automatic_lod = 7;
constexpr int lod = 8;
// Of the shading pass.
constexpr int light_count = 9;
}  // namespace uniform

/// Geometry pass: a mesh into the textures of a `GeometryBuffer`.
std::string geometry_vertex_shader();
std::string geometry_fragment_shader();

/// Shading pass, over the whole picture with `full_screen_vertex_shader`.
/// @param appearance  GLSL that defines btf_evaluate (`GpuAppearance::source`).
/// @param first_unit  texture unit of the first of the GeometryBuffer's textures.
std::string shading_fragment_shader(const std::string& appearance, std::size_t first_unit);

}  // namespace weft
