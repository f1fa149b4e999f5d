// The GLSL around a representation's btf_evaluate: camera, local frame and sum over lights.
#pragma once

#include <string>

namespace weft {

/// Uniform locations of the shaders below.
namespace uniform {
constexpr int eye = 0;
constexpr int view_rows = 1;  // an array of 3
constexpr int projection = 4;
constexpr int repeat = 5;
constexpr int texels = 6;
constexpr int light_count = 7;
constexpr int automatic_lod = 8;
constexpr int lod = 9;
}  // namespace uniform

std::string vertex_shader();
/// Writes depth only.
std::string depth_shader();
/// @param appearance  GLSL that defines btf_evaluate (`GpuAppearance::source`).
std::string fragment_shader(const std::string& appearance);

}  // namespace weft
