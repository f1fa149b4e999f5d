// The GLSL twin of PcaRepresentation::evaluate, and the textures that it fetches from.

#include <fmt/core.h>

#include "codecs/pca/pca_representation.h"
#include "codecs/stencil_glsl.h"

namespace weft::pca {

namespace {

// Quads are four components each; `btf_weight` holds the blended weights of one set.
constexpr const char* evaluate_glsl = R"(
vec4 btf_weight[btf_quads];

void btf_blend_weights(int set, btf_TexelStencil texels) {
  for (int q = 0; q < btf_quads; ++q) {
    btf_weight[q] = vec4(0.0);
    for (int t = 0; t < 4; ++t) {
      int texel = (set * btf_size.y + texels.texel[t].y) * btf_size.x + texels.texel[t].x;
      btf_weight[q] += btf_weights_quad(texel * btf_quads + q) * texels.weight[t];
    }
    btf_weight[q] *= texelFetch(btf_scale, set * btf_quads + q);
  }
}

vec3 btf_pair(int pair) {
  vec3 value = btf_mean_of(pair) * btf_mean_scale;
  for (int q = 0; q < btf_quads; ++q) {
    int first = 3 * pair * btf_quads + q;
    value.r += dot(btf_weight[q], btf_basis_quad(first));
    value.g += dot(btf_weight[q], btf_basis_quad(first + btf_quads));
    value.b += dot(btf_weight[q], btf_basis_quad(first + 2 * btf_quads));
  }
  return value;
}

vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {
  if (!(light.z > 0.0) || !(view.z > 0.0)) return vec3(0.0);
  btf_TexelStencil texels = btf_bilinear_texels(uv, btf_size);
  btf_Stencil views = btf_views_locate(view);
  btf_Stencil lights = btf_lights_locate(light);
  vec3 light_weight;
  for (int i = 0; i < 3; ++i) {
    light_weight[i] = lights.weight[i] * texelFetch(btf_inverse_cosines, lights.index[i]).r * light.z;
  }
  if (btf_sets == 1) btf_blend_weights(0, texels);
  vec3 sum = vec3(0.0);
  for (int v = 0; v < 3; ++v) {
    if (views.weight[v] == 0.0) continue;
    if (btf_sets > 1) btf_blend_weights(views.index[v], texels);
    int row = views.index[v] * btf_n_lights;
    for (int l = 0; l < 3; ++l) {
      if (lights.weight[l] == 0.0) continue;
      sum += btf_pair(row + lights.index[l]) * (views.weight[v] * light_weight[l]);
    }
  }
  return max(sum, vec3(0.0));
}
)";

}  // namespace

GlProgram PcaRepresentation::gl_program() const {
  GlProgram program;
  const std::size_t quads = model_.padded() / 4;
  program.glsl = texel_stencil_glsl() + direction_stencil_glsl();
  for (const auto& [sampling, prefix] :
       {std::pair(&lights(), "btf_lights"), std::pair(&views(), "btf_views")}) {
    GlProgram part = hemisphere_sampling_glsl(*sampling, prefix);
    program.glsl += part.glsl;
    for (GlTexture& table : part.textures) program.textures.push_back(std::move(table));
  }
  program.textures.push_back(
      buffer_texture("btf_inverse_cosines", GlTexture::Format::r32f, inverse_cosines(lights())));
  program.textures.push_back(stored_texture("btf_weights", model_.storage, model_.weights));
  program.textures.push_back(stored_texture("btf_basis", model_.storage, model_.basis));
  program.textures.push_back(stored_texture("btf_mean", model_.mean_storage(), model_.mean));
  program.textures.push_back(buffer_texture("btf_scale", GlTexture::Format::rgba32f, model_.scale));
  program.glsl += fmt::format(
      "\nconst ivec2 btf_size = ivec2({}, {});\nconst int btf_n_lights = {};\n"
      "const int btf_quads = {};\nconst int btf_sets = {};\nconst float btf_mean_scale = {:.9e};\n",
      model_.head.width, model_.head.height, lights().size(), quads, model_.sets,
      model_.mean_scale);
  program.glsl += fmt::format(
      "vec4 btf_weights_quad(int i) {{ return {}; }}\nvec4 btf_basis_quad(int i) {{ return {}; }}\n"
      "vec3 btf_mean_of(int i) {{ return {}.rgb; }}\n",
      stored_fetch("btf_weights", "i", model_.storage),
      stored_fetch("btf_basis", "i", model_.storage),
      stored_fetch("btf_mean", "i", model_.mean_storage()));
  program.glsl += evaluate_glsl;
  return program;
}

}  // namespace weft::pca
