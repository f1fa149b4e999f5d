// The GLSL twin of SrbfRepresentation::evaluate, and the textures that it fetches from.

#include <fmt/core.h>

#include "codecs/srbf/srbf_representation.h"
#include "codecs/stencil_glsl.h"

namespace weft::srbf {

namespace {

// Which texels' rows are blended, and one quad of four kernels' numbers.
constexpr const char* evaluate_glsl = R"(
int btf_row[8];
float btf_weight[8];
int btf_rows;

void btf_add_level(vec2 uv, int level, float share) {
  ivec2 size = max(btf_size >> level, ivec2(1));
  int first = 0;
  for (int l = 0; l < level; ++l) {
    ivec2 finer = max(btf_size >> l, ivec2(1));
    first += finer.x * finer.y;
  }
  btf_TexelStencil texels = btf_bilinear_texels(uv, size);
  for (int t = 0; t < 4; ++t) {
    btf_row[btf_rows] = (first + texels.texel[t].y * size.x + texels.texel[t].x) * btf_quads;
    btf_weight[btf_rows++] = texels.weight[t] * share;
  }
}

vec4 btf_blended(int quad) {
  vec4 sum = vec4(0.0);
  for (int i = 0; i < btf_rows; ++i) sum += btf_kernel_quad(btf_row[i] + quad) * btf_weight[i];
  return sum * texelFetch(btf_scale, quad);
}

vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {
  if (!(light.z > 0.0) || !(view.z > 0.0)) return vec3(0.0);
  float lambda = lod > 0.0 ? min(lod, float(btf_levels - 1)) : 0.0;
  int level = int(lambda);
  float blend = lambda - float(level);
  btf_rows = 0;
  btf_add_level(uv, level, 1.0 - blend);
  if (blend > 0.0) btf_add_level(uv, level + 1, blend);
  vec4 angle = btf_blended(btf_quads - 1);
  vec3 psi[btf_modes];
  for (int k = 0; k < btf_modes; ++k) {
    vec3 sum = light * cos(angle[k]) + view * sin(angle[k]);
    psi[k] = sum / sqrt(dot(sum, sum) + btf_smallest_square);
  }
  vec3 value = vec3(0.0);
  int quad = 0;
  while (quad < btf_quads - 1) {
    vec4 exponent = vec4(0.0);
    for (int k = 0; k < btf_modes; ++k) {
      vec4 x = btf_blended(quad++);
      vec4 y = btf_blended(quad++);
      vec4 z = btf_blended(quad++);
      exponent += x * psi[k].x + y * psi[k].y + z * psi[k].z -
                  sqrt(x * x + y * y + z * z + btf_rounding_square);
    }
    vec4 kernel = exp(max(exponent, vec4(-87.0)));
    value.r += dot(kernel, btf_blended(quad++));
    value.g += dot(kernel, btf_blended(quad++));
    value.b += dot(kernel, btf_blended(quad++));
  }
  return max(value * btf_gain, vec3(0.0));
}
)";

}  // namespace

GlProgram SrbfRepresentation::gl_program() const {
  GlProgram program;
  program.textures.push_back(stored_texture("btf_kernels", model_.storage, model_.values));
  program.textures.push_back(buffer_texture("btf_scale", GlTexture::Format::rgba32f, model_.scale));
  program.glsl = texel_stencil_glsl();
  program.glsl += fmt::format(
      "\nconst ivec2 btf_size = ivec2({}, {});\nconst int btf_levels = {};\n"
      "const int btf_quads = {};\nconst int btf_modes = {};\n"
      "const float btf_smallest_square = {:.9e};\nconst float btf_rounding_square = {:.9e};\n"
      "#define btf_gain {}\nvec4 btf_kernel_quad(int i) {{ return {}; }}\n",
      model_.head.width, model_.head.height, model_.sizes().levels(), model_.layout().quads(),
      model_.shape.modes, smallest_square, rounding_square,
      model_.quantity == Quantity::over_cosine ? "light.z" : "1.0",
      stored_fetch("btf_kernels", "i", model_.storage));
  program.glsl += evaluate_glsl;
  return program;
}

}  // namespace weft::srbf
