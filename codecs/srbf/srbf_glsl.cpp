// The GLSL twin of SrbfRepresentation::evaluate, and the textures that it fetches from.

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "codecs/srbf/srbf_representation.h"
#include "codecs/stencil_glsl.h"

namespace weft::srbf {

namespace {

// One quad of four kernels' numbers, blended here.
constexpr const char* exact_glsl = R"(
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

void btf_place(vec2 uv, float lambda) {
  int level = int(lambda);
  float blend = lambda - float(level);
  btf_rows = 0;
  btf_add_level(uv, level, 1.0 - blend);
  if (blend > 0.0) btf_add_level(uv, level + 1, blend);
}

vec4 btf_blended(int quad) {
  vec4 sum = vec4(0.0);
  for (int i = 0; i < btf_rows; ++i) sum += btf_kernel_quad(btf_row[i] + quad) * btf_weight[i];
  return sum * texelFetch(btf_scale, quad);
}
)";

// The same by the GPU's filter: a layer a quad.
constexpr const char* hardware_glsl = R"(
vec2 btf_at;
float btf_lod;

void btf_place(vec2 uv, float lambda) {
  btf_at = vec2(uv.x, 1.0 - uv.y);
  btf_lod = lambda;
}

vec4 btf_blended(int quad) { return btf_kernel_quad(quad) * texelFetch(btf_scale, quad); }
)";

constexpr const char* evaluate_glsl = R"(
vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {
  if (!(light.z > 0.0) || !(view.z > 0.0)) return vec3(0.0);
  float lambda = lod > 0.0 ? min(lod, float(btf_levels - 1)) : 0.0;
  btf_place(uv, lambda);
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

// [level][quad][row][column] of what the buffer holds as [level][row][column][quad].
std::vector<std::byte> SrbfRepresentation::filtered_bytes() const {
  const std::vector<std::byte> rows =
      stored_texture("btf_kernels", model_.storage, model_.values).bytes;
  const MipSizes sizes = model_.sizes();
  const std::size_t quads = model_.layout().quads();
  const std::size_t quad_bytes = 4 * bytes_a_value(model_.storage);
  std::vector<std::byte> layers(rows.size());
  auto to = layers.begin();
  for (int level = 0; level < sizes.levels(); ++level) {
    for (std::size_t quad = 0; quad < quads; ++quad) {
      for (std::size_t texel = 0; texel < sizes.texels(level); ++texel) {
        const std::size_t from = ((first_texel_[level] + texel) * quads + quad) * quad_bytes;
        to = std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(from), quad_bytes, to);
      }
    }
  }
  return layers;
}

GlProgram SrbfRepresentation::gl_program() const {
  GlProgram program;
  const bool hardware = model_.filtering == Filtering::hardware;
  GlTexture kernels = stored_texture("btf_kernels", model_.storage, model_.values);
  if (hardware) {
    kernels = {.name = kernels.name,
               .kind = GlTexture::Kind::array_2d,
               .format = kernels.format,
               .width = model_.head.width,
               .height = model_.head.height,
               .layers = static_cast<int>(model_.layout().quads()),
               .bytes = filtered_bytes(),
               .levels = model_.sizes().levels()};
  }
  program.textures.push_back(std::move(kernels));
  program.textures.push_back(buffer_texture("btf_scale", GlTexture::Format::rgba32f, model_.scale));
  program.glsl = texel_stencil_glsl();
  program.glsl += fmt::format(
      "\nconst ivec2 btf_size = ivec2({}, {});\nconst int btf_levels = {};\n"
      "const int btf_quads = {};\nconst int btf_modes = {};\n"
      "const float btf_smallest_square = {:.9e};\nconst float btf_rounding_square = {:.9e};\n"
      "#define btf_gain {}\n",
      model_.head.width, model_.head.height, model_.sizes().levels(), model_.layout().quads(),
      model_.shape.modes, smallest_square, rounding_square,
      model_.quantity == Quantity::over_cosine ? "light.z" : "1.0");
  if (hardware) {
    const std::string byte =
        model_.storage == Storage::eight_bit ? " * 255.0 - 128.0) / 127.0" : ")";
    program.glsl += std::string(hardware_glsl)
                        .insert(std::string_view(hardware_glsl).find("vec4 btf_blended"),
                                fmt::format("vec4 btf_kernel_quad(int i) {{ return "
                                            "(textureLod(btf_kernels, vec3(btf_at, i), "
                                            "btf_lod){}; }}\n",
                                            byte));
  } else {
    program.glsl += fmt::format("vec4 btf_kernel_quad(int i) {{ return {}; }}\n",
                                stored_fetch("btf_kernels", "i", model_.storage));
    program.glsl += exact_glsl;
  }
  program.glsl += evaluate_glsl;
  return program;
}

}  // namespace weft::srbf
