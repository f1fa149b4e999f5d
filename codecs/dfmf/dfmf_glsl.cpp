// The GLSL twin of DfmfRepresentation::evaluate, and the textures that it fetches from.

#include <fmt/core.h>

#include "codecs/dfmf/colour.h"
#include "codecs/dfmf/dfmf_representation.h"
#include "codecs/stencil_glsl.h"

namespace weft::dfmf {

namespace {

constexpr const char* evaluate_glsl = R"(
// f of one texel and one pair.
vec3 btf_sample(int texel, int pair) {
  vec3 abc = vec3(0.0);
  for (int q = 0; q < btf_quads; ++q) {
    float part = dot(btf_weights_quad(texel * btf_quads + q) * texelFetch(btf_scale, q),
                     btf_basis_quad(pair * btf_quads + q));
    abc[q < btf_first_b ? 0 : q < btf_first_c ? 1 : 2] += part;
  }
  float bright = btf_epsilon * exp(clamp(abc.x, -87.0, 88.0));
  float y = bright - btf_epsilon;
  float u = abc.y * bright;
  float v = abc.z * bright;
  return max(vec3(y + btf_red_of_v * v, y - btf_green_of_u * u - btf_green_of_v * v,
                  y + btf_blue_of_u * u), vec3(0.0));
}

vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {
  if (!(light.z > 0.0) || !(view.z > 0.0)) return vec3(0.0);
  btf_TexelStencil texels = btf_bilinear_texels(uv, btf_size);
  btf_Stencil views = btf_views_locate(view);
  btf_Stencil lights = btf_lights_locate(light);
  vec3 sum = vec3(0.0);
  for (int v = 0; v < 3; ++v) {
    for (int l = 0; l < 3; ++l) {
      float weight = views.weight[v] * lights.weight[l];
      if (weight == 0.0) continue;
      int pair = views.index[v] * btf_n_lights + lights.index[l];
      for (int t = 0; t < 4; ++t) {
        int texel = texels.texel[t].y * btf_size.x + texels.texel[t].x;
        sum += btf_sample(texel, pair) * (weight * texels.weight[t]);
      }
    }
  }
  return sum * light.z;
}
)";

}  // namespace

GlProgram DfmfRepresentation::gl_program() const {
  GlProgram program;
  program.glsl = texel_stencil_glsl() + direction_stencil_glsl();
  for (const auto& [sampling, prefix] :
       {std::pair(&lights(), "btf_lights"), std::pair(&views(), "btf_views")}) {
    GlProgram part = hemisphere_sampling_glsl(*sampling, prefix);
    program.glsl += part.glsl;
    for (GlTexture& table : part.textures) program.textures.push_back(std::move(table));
  }
  program.textures.push_back(stored_texture("btf_weights", model_.storage, model_.weights));
  program.textures.push_back(stored_texture("btf_basis", model_.storage, model_.basis));
  program.textures.push_back(buffer_texture("btf_scale", GlTexture::Format::rgba32f, model_.scale));
  program.glsl += fmt::format(
      "\nconst ivec2 btf_size = ivec2({}, {});\nconst int btf_n_lights = {};\n"
      "const int btf_quads = {};\nconst int btf_first_b = {};\nconst int btf_first_c = {};\n"
      "const float btf_epsilon = {:.9e};\n",
      model_.head.width, model_.head.height, lights().size(), model_.slots() / 4,
      model_.first_slot(1) / 4, model_.first_slot(2) / 4, model_.epsilon);
  program.glsl += fmt::format(
      "const float btf_red_of_v = {:.9e};\nconst float btf_green_of_u = {:.9e};\n"
      "const float btf_green_of_v = {:.9e};\nconst float btf_blue_of_u = {:.9e};\n",
      red_of_v, green_of_u, green_of_v, blue_of_u);
  program.glsl += fmt::format(
      "vec4 btf_weights_quad(int i) {{ return {}; }}\nvec4 btf_basis_quad(int i) {{ return {}; "
      "}}\n",
      stored_fetch("btf_weights", "i", model_.storage),
      stored_fetch("btf_basis", "i", model_.storage));
  program.glsl += evaluate_glsl;
  return program;
}

}  // namespace weft::dfmf
