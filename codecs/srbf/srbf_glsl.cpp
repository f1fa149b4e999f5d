// The GLSL twin of SrbfRepresentation::evaluate, and the textures that it fetches from.

#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "codecs/srbf/srbf_representation.h"
#include "codecs/stencil_glsl.h"

namespace weft::srbf {

namespace {

// The kernels' sum of the numbers that `btf_quad` gives, four kernels' at a time.
constexpr const char* value_glsl = R"(
vec3 btf_value(vec3 light, vec3 view) {
  vec4 angle = btf_quad(btf_quads - 1);
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
      vec4 x = btf_quad(quad++);
      vec4 y = btf_quad(quad++);
      vec4 z = btf_quad(quad++);
      exponent += x * psi[k].x + y * psi[k].y + z * psi[k].z -
                  sqrt(x * x + y * y + z * z + btf_rounding_square);
    }
    vec4 kernel = exp(max(exponent, vec4(-87.0)));
    value.r += dot(kernel, btf_quad(quad++));
    value.g += dot(kernel, btf_quad(quad++));
    value.b += dot(kernel, btf_quad(quad++));
  }
  return value * btf_gain;
}
)";

// Sums are blended: texel by texel, level by level.
constexpr const char* values_glsl = R"(
vec3 btf_level_value(vec2 uv, vec3 light, vec3 view, int level) {
  ivec2 size = max(btf_size >> level, ivec2(1));
  int first = 0;
  for (int l = 0; l < level; ++l) {
    ivec2 finer = max(btf_size >> l, ivec2(1));
    first += finer.x * finer.y;
  }
  btf_TexelStencil texels = btf_bilinear_texels(uv, size);
  vec3 sum = vec3(0.0);
  for (int t = 0; t < 4; ++t) {
    btf_row = (first + texels.texel[t].y * size.x + texels.texel[t].x) * btf_quads;
    sum += texels.weight[t] * btf_value(light, view);
  }
  return sum;
}

vec3 btf_filtered(vec2 uv, vec3 light, vec3 view, float lambda) {
  int level = int(lambda);
  float blend = lambda - float(level);
  vec3 fine = btf_level_value(uv, light, view, level);
  if (blend == 0.0) return fine;
  return mix(fine, btf_level_value(uv, light, view, level + 1), blend);
}
)";

// Numbers are blended, by the GPU's filter.
constexpr const char* numbers_glsl = R"(
vec3 btf_filtered(vec2 uv, vec3 light, vec3 view, float lambda) {
  btf_at = vec2(uv.x, 1.0 - uv.y);
  btf_lod = lambda;
  return btf_value(light, view);
}
)";

constexpr const char* evaluate_glsl = R"(
vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {
  if (!(light.z > 0.0) || !(view.z > 0.0)) return vec3(0.0);
  float lambda = lod > 0.0 ? min(lod, float(btf_levels - 1)) : 0.0;
  return max(btf_filtered(uv, light, view, lambda), vec3(0.0));
}
)";

// Four kernels' numbers as the GPU's filter finds them: a layer a quad.
std::string filtered_quad(Storage storage) {
  return fmt::format(
      "vec2 btf_at;\nfloat btf_lod;\n"
      "vec4 btf_quad(int i) {{ return (textureLod(btf_kernels, vec3(btf_at, i), "
      "btf_lod){} * texelFetch(btf_scale, i); }}\n",
      storage == Storage::eight_bit ? " * 255.0 - 128.0) / 127.0" : ")");
}

// Those of the texel that begins at btf_row.
std::string fetched_quad(Storage storage) {
  return fmt::format(
      "int btf_row;\nvec4 btf_quad(int i) {{ return {} * texelFetch(btf_scale, i); "
      "}}\n",
      stored_fetch("btf_kernels", "btf_row + i", storage));
}

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
  const bool by_gpu = model_.filtering == Filtering::numbers;
  GlTexture kernels = stored_texture("btf_kernels", model_.storage, model_.values);
  if (by_gpu) {
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
  program.glsl += by_gpu ? filtered_quad(model_.storage) : fetched_quad(model_.storage);
  program.glsl += value_glsl;
  program.glsl += by_gpu ? numbers_glsl : values_glsl;
  program.glsl += evaluate_glsl;
  return program;
}

}  // namespace weft::srbf
