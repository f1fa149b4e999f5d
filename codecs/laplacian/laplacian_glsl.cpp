// The GLSL twin of LaplacianRepresentation::evaluate, and the paper's two maps.

#include <fmt/core.h>

#include "btf/raw_appearance.h"
#include "codecs/laplacian/colour.h"
#include "codecs/laplacian/laplacian_representation.h"
#include "codecs/stencil_glsl.h"

namespace weft::laplacian {

namespace {

// A float written so that GLSL reads the same one.
std::string literal(float value) {
  return fmt::format("{:.9e}", value);
}

GlTexture map_texture(std::string name, Storage storage, Texel size,
                      const std::vector<float>& map) {
  GlTexture texture = stored_texture(std::move(name), storage, map);
  texture.kind = GlTexture::Kind::image_2d;
  texture.width = size.x;
  texture.height = size.y;
  return texture;
}

constexpr const char* levels_glsl = R"(
// D^T E of one level, for Y, Cb and Cr.
vec3 btf_level(int level, ivec2 texel[4], float weight[4], int views[9], int lights[9],
               float pair_weight[9], int pairs) {
  vec3 sum = vec3(0.0);
  for (int q = 0; q < btf_quads; ++q) {
    ivec2 block = btf_block[level * btf_quads + q];
    vec4 d = vec4(0.0);
    for (int t = 0; t < 4; ++t) d += btf_weight_quad(block + texel[t]) * weight[t];
    vec4 e = vec4(0.0);
    for (int i = 0; i < pairs; ++i) {
      e += btf_eigen_quad(ivec2(q * btf_n_lights + lights[i], level * btf_n_views + views[i])) *
           pair_weight[i];
    }
    vec4 value = d * e * texelFetch(btf_scale, level * btf_quads + q);
    for (int k = 0; k < 4; ++k) {
      int slot = 4 * q + k;
      int channel = slot < btf_first_cb ? 0 : slot < btf_first_cr ? 1 : 2;
      sum[channel] += value[k];
    }
  }
  return sum;
}

// The levels from `grid` on at its four texels, each with its own parents.
vec3 btf_boxes(vec2 uv, int grid, int views[9], int lights[9], float pair_weight[9], int pairs) {
  btf_TexelStencil corners = btf_bilinear_texels(uv, btf_level_size[grid]);
  vec3 sum = vec3(0.0);
  for (int level = grid; level <= btf_top; ++level) {
    ivec2 texel[4];
    for (int t = 0; t < 4; ++t) texel[t] = min(corners.texel[t] >> (level - grid), btf_level_size[level] - 1);
    sum += btf_level(level, texel, corners.weight, views, lights, pair_weight, pairs);
  }
  return sum;
}

vec3 btf_linear(vec2 uv, int first, float blend, int views[9], int lights[9], float pair_weight[9],
                int pairs) {
  vec3 sum = vec3(0.0);
  for (int level = first; level <= btf_top; ++level) {
    btf_TexelStencil texels = btf_bilinear_texels(uv, btf_level_size[level]);
    sum += (level == first ? 1.0 - blend : 1.0) *
           btf_level(level, texels.texel, texels.weight, views, lights, pair_weight, pairs);
  }
  return sum;
}

vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {
  if (!(light.z > 0.0) || !(view.z > 0.0)) return vec3(0.0);
  int views[9];
  int lights[9];
  float pair_weight[9];
  int pairs = btf_pairs(light, view, views, lights, pair_weight);
  float lambda = lod > 0.0 ? min(lod, float(btf_top)) : 0.0;
  int first = int(lambda);
  float blend = lambda - float(first);
  vec3 ycbcr;
  if (btf_is_linear) {
    ycbcr = btf_linear(uv, first, blend, views, lights, pair_weight, pairs);
  } else {
    ycbcr = (1.0 - blend) * btf_boxes(uv, first, views, lights, pair_weight, pairs);
    if (blend > 0.0) ycbcr += blend * btf_boxes(uv, first + 1, views, lights, pair_weight, pairs);
  }
  ycbcr += btf_mean(light, view);
  return max(vec3(ycbcr.x + btf_red_of_cr * ycbcr.z,
                  ycbcr.x - btf_green_of_cb * ycbcr.y - btf_green_of_cr * ycbcr.z,
                  ycbcr.x + btf_blue_of_cb * ycbcr.y), vec3(0.0));
}
)";

constexpr const char* nearest_pairs_glsl = R"(
int btf_pairs(vec3 light, vec3 view, out int views[9], out int lights[9], out float weight[9]) {
  views[0] = btf_views_nearest(view);
  lights[0] = btf_lights_nearest(light);
  weight[0] = 1.0;
  return 1;
}
)";

constexpr const char* weighted_pairs_glsl = R"(
int btf_pairs(vec3 light, vec3 view, out int views[9], out int lights[9], out float weight[9]) {
  btf_Stencil v = btf_views_locate(view);
  btf_Stencil l = btf_lights_locate(light);
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (v.weight[i] * l.weight[j] == 0.0) continue;
      views[count] = v.index[i];
      lights[count] = l.index[j];
      weight[count++] = v.weight[i] * l.weight[j] * light.z *
                        texelFetch(btf_inverse_cosines, l.index[j]).r;
    }
  }
  return count;
}
)";

std::string tables_glsl(const Model& model) {
  std::string sizes;
  std::string blocks;
  for (int level = 0; level < model.levels(); ++level) {
    sizes += fmt::format("{}ivec2({}, {})", level == 0 ? "" : ", ", model.pyramid.width_of(level),
                         model.pyramid.height_of(level));
    for (std::size_t quad = 0; quad < model.quads(); ++quad) {
      const Texel block = model.weight_block(level, quad);
      blocks += fmt::format("{}ivec2({}, {})", blocks.empty() ? "" : ", ", block.x, block.y);
    }
  }
  std::string text = fmt::format(
      "\nconst int btf_top = {};\nconst int btf_quads = {};\nconst int btf_n_lights = {};\n"
      "const int btf_n_views = {};\nconst int btf_first_cb = {};\nconst int btf_first_cr = {};\n"
      "const bool btf_is_linear = {};\n",
      model.pyramid.top, model.quads(), model.head.lights.size(), model.head.views.size(),
      model.first_slot(1), model.first_slot(2), model.pyramid.filters == Filters::linear);
  text +=
      fmt::format("const ivec2 btf_level_size[{0}] = ivec2[{0}]({1});\n", model.levels(), sizes);
  text += fmt::format("const ivec2 btf_block[{0}] = ivec2[{0}]({1});\n",
                      model.levels() * model.quads(), blocks);
  text += fmt::format(
      "const float btf_red_of_cr = {};\nconst float btf_green_of_cb = {};\n"
      "const float btf_green_of_cr = {};\nconst float btf_blue_of_cb = {};\n",
      literal(red_of_cr), literal(green_of_cb), literal(green_of_cr), literal(blue_of_cb));
  return text;
}

// Equations 5 and 6.
std::string mean_glsl(const Model& model) {
  const Phong& phong = model.mean_y;
  return fmt::format(
      "vec3 btf_mean(vec3 light, vec3 view) {{\n"
      "  vec3 sum = light + view;\n"
      "  float y = {} + {} * light.z + {} * pow(sum.z / sqrt(dot(sum, sum)), {});\n"
      "  return vec3(y, vec2({}, {}){});\n"
      "}}\n",
      literal(phong.ka), literal(phong.kd), literal(phong.ks), literal(phong.alpha),
      literal(model.mean_chroma[0]), literal(model.mean_chroma[1]),
      model.chroma == ChromaMean::cosine ? " * light.z" : "");
}

void append(GlProgram part, GlProgram& program) {
  program.glsl += part.glsl;
  for (GlTexture& table : part.textures) program.textures.push_back(std::move(table));
}

}  // namespace

GlProgram LaplacianRepresentation::gl_program() const {
  GlProgram program;
  const Storage storage = model_.storage;
  program.textures.push_back(
      map_texture("btf_eigen", storage, model_.eigen_map_size(), model_.eigen_map()));
  program.textures.push_back(
      map_texture("btf_weights", storage, model_.weight_map_size(), model_.weight_map()));
  program.textures.push_back(buffer_texture("btf_scale", GlTexture::Format::rgba32f, model_.scale));
  program.glsl = texel_stencil_glsl();
  if (model_.interpolated) {
    program.textures.push_back(
        buffer_texture("btf_inverse_cosines", GlTexture::Format::r32f, inverse_cosines(lights())));
    program.glsl += direction_stencil_glsl();
    append(hemisphere_sampling_glsl(lights(), "btf_lights"), program);
    append(hemisphere_sampling_glsl(views(), "btf_views"), program);
    program.glsl += weighted_pairs_glsl;
  } else {
    append(nearest_light_.glsl("btf_lights"), program);
    append(nearest_view_.glsl("btf_views"), program);
    program.glsl += nearest_pairs_glsl;
  }
  program.glsl += tables_glsl(model_);
  program.glsl += fmt::format(
      "vec4 btf_eigen_quad(ivec2 p) {{ return {}; }}\nvec4 btf_weight_quad(ivec2 p) {{ return {}; "
      "}}\n",
      stored_fetch("btf_eigen", "p, 0", storage), stored_fetch("btf_weights", "p, 0", storage));
  program.glsl += mean_glsl(model_);
  program.glsl += levels_glsl;
  return program;
}

}  // namespace weft::laplacian
