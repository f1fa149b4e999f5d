// The GLSL twin of LafortuneRepresentation::evaluate, and the texture that it fetches from.

#include <fmt/core.h>

#include "codecs/lafortune/lafortune_representation.h"
#include "codecs/stencil_glsl.h"

namespace weft::lafortune {

namespace {

constexpr const char* evaluate_glsl = R"(
vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {
  if (!(light.z > 0.0) || !(view.z > 0.0)) return vec3(0.0);
  btf_TexelStencil texels = btf_bilinear_texels(uv, btf_size);
  vec3 m = light * view;
  vec3 sum = vec3(0.0);
  for (int t = 0; t < 4; ++t) {
    int first = (texels.texel[t].y * btf_size.x + texels.texel[t].x) * (btf_lobes + 1);
    vec4 last = texelFetch(btf_texels, first + btf_lobes);
    float value = last.a;
    for (int k = 0; k < btf_lobes; ++k) {
      vec4 c = texelFetch(btf_texels, first + k);
      float peak = max(max(abs(c.x), abs(c.y)), abs(c.z));
      float product = dot(c.xyz, m);
      if (product > 0.0) value += peak * pow(product / peak, c.w);
    }
    sum += last.rgb * (value * texels.weight[t]);
  }
  return sum * (btf_scale * light.z);
}
)";

}  // namespace

GlProgram LafortuneRepresentation::gl_program() const {
  GlProgram program;
  program.textures.push_back(stored_texture("btf_texels", model_.storage, model_.texels));
  program.glsl = texel_stencil_glsl();
  program.glsl += fmt::format(
      "\nconst ivec2 btf_size = ivec2({}, {});\nconst int btf_lobes = {};\n"
      "const float btf_scale = {:.9e};\n",
      model_.head.width, model_.head.height, model_.lobes, model_.scale);
  program.glsl += evaluate_glsl;
  return program;
}

}  // namespace weft::lafortune
