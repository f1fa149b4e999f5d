// The GLSL twin of FieldRepresentation::evaluate, and the textures that it fetches from.

#include <fmt/core.h>

#include "codecs/reflectance_fields/representation.h"
#include "codecs/stencil_glsl.h"

namespace weft::reflectance_fields {

namespace {

constexpr const char* lobes_glsl = R"(
// Equation 1: (a, b, c) = |w|^(1/n - 1) w.
vec3 btf_field(int first, vec3 light) {
  float value = 0.0;
  for (int k = 0; k < btf_lobes; ++k) {
    vec4 q = texelFetch(btf_fields, first + k);
    float peak = length(q.xyz);
    float s = dot(q.xyz, light);
    if (s > 0.0) value += peak * pow(s / peak, q.w);
  }
  return texelFetch(btf_fields, first + btf_lobes).rgb * value;
}
)";

constexpr const char* luminance_glsl = R"(
vec3 btf_field(int first, vec3 light) {
  vec4 a = texelFetch(btf_fields, first);
  vec4 b = texelFetch(btf_fields, first + 1);
  float value = dot(a, vec4(light.x * light.x, light.y * light.y, light.x * light.y, light.x)) +
                b.x * light.y + b.y;
  return texelFetch(btf_fields, first + 2).rgb * max(value, 0.0);
}
)";

constexpr const char* rgb_glsl = R"(
vec3 btf_field(int first, vec3 light) {
  float basis[6] = float[6](light.x * light.x, light.y * light.y, light.x * light.y, light.x,
                            light.y, 1.0);
  vec3 value = vec3(0.0);
  for (int k = 0; k < 6; ++k) value += texelFetch(btf_fields, first + k).rgb * basis[k];
  return max(value, vec3(0.0));
}
)";

constexpr const char* evaluate_glsl = R"(
vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {
  if (!(light.z > 0.0) || !(view.z > 0.0)) return vec3(0.0);
  btf_TexelStencil texels = btf_bilinear_texels(uv, btf_size);
  btf_QuadStencil views = btf_views_locate(view);
  vec3 sum = vec3(0.0);
  for (int v = 0; v < 4; ++v) {
    if (views.weight[v] == 0.0) continue;
    for (int t = 0; t < 4; ++t) {
      ivec2 texel = texels.texel[t];
      int field = (views.index[v] * btf_size.y + texel.y) * btf_size.x + texel.x;
      sum += btf_field(field * btf_quads, light) * (views.weight[v] * texels.weight[t]);
    }
  }
  return sum * (btf_has_cosine ? btf_scale * light.z : btf_scale);
}
)";

}  // namespace

GlProgram FieldRepresentation::gl_program() const {
  GlProgram program = view_stencil_.glsl(model_.head.views, "btf_views");
  program.glsl = texel_stencil_glsl() + direction_stencil_glsl() + program.glsl;
  program.textures.push_back(stored_texture("btf_fields", model_.storage, model_.fields));
  program.glsl += fmt::format(
      "\nconst ivec2 btf_size = ivec2({}, {});\nconst int btf_quads = {};\n"
      "const int btf_lobes = {};\nconst bool btf_has_cosine = {};\n"
      "const float btf_scale = {:.9e};\n",
      model_.head.width, model_.head.height, model_.quads(), model_.lobes, has_cosine(model_.kind),
      model_.scale);
  program.glsl += model_.kind == Kind::lobes ? lobes_glsl
                  : is_rgb(model_.kind)      ? rgb_glsl
                                             : luminance_glsl;
  program.glsl += evaluate_glsl;
  return program;
}

}  // namespace weft::reflectance_fields
