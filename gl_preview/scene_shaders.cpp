// The shaders' texts. Names start with weft_, so that they don't meet those of a representation.

#include "gl_preview/scene_shaders.h"

#include <fmt/core.h>

namespace weft {

std::string geometry_vertex_shader() {
  return R"(#version 450 core
layout(location = 0) in vec3 weft_in_position;
layout(location = 1) in vec3 weft_in_normal;
layout(location = 2) in vec3 weft_in_tangent;
layout(location = 3) in vec2 weft_in_texcoord;
layout(location = 0) uniform vec3 weft_eye;
layout(location = 1) uniform vec3 weft_view_rows[3];  // right, up, forward
layout(location = 4) uniform vec3 weft_projection;    // scales of x and y, near plane
layout(location = 0) out vec3 weft_position;
layout(location = 1) out vec3 weft_normal;
layout(location = 2) out vec3 weft_tangent;
layout(location = 3) out vec2 weft_texcoord;
void main() {
  weft_position = weft_in_position;
  weft_normal = weft_in_normal;
  weft_tangent = weft_in_tangent;
  weft_texcoord = weft_in_texcoord;
  vec3 d = weft_in_position - weft_eye;
  vec3 seen = vec3(dot(weft_view_rows[0], d), dot(weft_view_rows[1], d), dot(weft_view_rows[2], d));
  gl_Position = vec4(seen.xy * weft_projection.xy, weft_projection.z, seen.z);
}
)";
}

std::string geometry_fragment_shader() {
  return R"(#version 450 core
layout(location = 0) in vec3 weft_position;
layout(location = 1) in vec3 weft_normal;
layout(location = 2) in vec3 weft_tangent;
layout(location = 3) in vec2 weft_texcoord;
layout(location = 5) uniform vec2 weft_repeat;
layout(location = 6) uniform vec2 weft_texels;  // of one tile
layout(location = 7) uniform bool weft_automatic_lod;
layout(location = 8) uniform float weft_lod;
layout(location = 0) out vec4 weft_position_lod;
layout(location = 1) out vec4 weft_normal_u;
layout(location = 2) out vec4 weft_tangent_v;
void main() {
  vec2 uv = weft_texcoord * weft_repeat;
  float lod = weft_lod;
  if (weft_automatic_lod) {
    vec2 across = dFdx(uv) * weft_texels;
    vec2 down = dFdy(uv) * weft_texels;
    // The wider of the pixel's two axes; never below one texel.
    lod = 0.5 * log2(max(max(dot(across, across), dot(down, down)), 1.0));
  }
  weft_position_lod = vec4(weft_position, lod);
  weft_normal_u = vec4(weft_normal, uv.x);
  weft_tangent_v = vec4(weft_tangent, uv.y);
}
)";
}

std::string shading_fragment_shader(const std::string& appearance, std::size_t first_unit) {
  const std::string samplers = fmt::format(
      "layout(binding = {}) uniform sampler2D weft_position_lod;\n"
      "layout(binding = {}) uniform sampler2D weft_normal_u;\n"
      "layout(binding = {}) uniform sampler2D weft_tangent_v;\n",
      first_unit, first_unit + 1, first_unit + 2);
  return "#version 450 core\n" + appearance + samplers + R"(
layout(location = 0) uniform vec3 weft_eye;
layout(location = 9) uniform int weft_light_count;
struct WeftLight { vec4 position; vec4 power; };  // w = 0: position is the direction to the light
layout(std430, binding = 0) readonly buffer WeftLights { WeftLight weft_lights[]; };
layout(location = 0) out vec4 weft_colour;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 position_lod = texelFetch(weft_position_lod, pixel, 0);
  vec4 normal_u = texelFetch(weft_normal_u, pixel, 0);
  vec4 tangent_v = texelFetch(weft_tangent_v, pixel, 0);
  vec3 position = position_lod.xyz;
  vec2 uv = vec2(normal_u.w, tangent_v.w);
  vec3 n = normalize(normal_u.xyz);
  vec3 t = tangent_v.xyz - n * dot(n, tangent_v.xyz);
  // A tangent along the normal: any perpendicular, the one that the path tracer takes.
  if (dot(t, t) == 0.0) {
    vec3 other = abs(n.x) < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
    t = other - n * dot(n, other);
  }
  t = normalize(t);
  vec3 b = cross(n, t);
  vec3 to_eye = normalize(weft_eye - position);
  vec3 view = vec3(dot(to_eye, t), dot(to_eye, b), dot(to_eye, n));
  vec3 sum = vec3(0.0);
  if (view.z > 0.0) {
    for (int i = 0; i < weft_light_count; ++i) {
      WeftLight light = weft_lights[i];
      vec3 d = light.position.xyz - position * light.position.w;
      float distance2 = dot(d, d);
      vec3 to_light = d * inversesqrt(distance2);
      // Irradiance perpendicular to the light's direction.
      vec3 irradiance = light.power.rgb / (light.position.w > 0.0 ? distance2 : 1.0);
      vec3 local = vec3(dot(to_light, t), dot(to_light, b), dot(to_light, n));
      if (local.z > 0.0) sum += btf_evaluate(uv, local, view, position_lod.w) * irradiance;
    }
  }
  weft_colour = vec4(sum, 1.0);
}
)";
}

}  // namespace weft
