// The GLSL twin of CmfRepresentation::evaluate, and the textures that it fetches from.

#include <fmt/core.h>

#include "btf/error.h"
#include "codecs/cmf/atlas.h"
#include "codecs/cmf/cmf_representation.h"
#include "codecs/stencil_glsl.h"

namespace weft::cmf {

namespace {

using Format = GlTexture::Format;

constexpr int max_texture_side = 16384;

GlTexture image_texture(std::string name, Format format, int width, int height,
                        std::span<const std::byte> bytes) {
  return {std::move(name),
          GlTexture::Kind::image_2d,
          format,
          width,
          height,
          1,
          {bytes.begin(), bytes.end()}};
}

GlTexture rgb_texture(std::string name, int width, int height,
                      const std::vector<std::uint8_t>& bytes, const std::vector<float>& floats) {
  return floats.empty() ? image_texture(std::move(name), Format::rgb8, width, height,
                                        std::as_bytes(std::span(bytes)))
                        : image_texture(std::move(name), Format::rgb32f, width, height,
                                        std::as_bytes(std::span(floats)));
}

GlTexture maps_texture(const Model& model, std::size_t factor) {
  const AtlasLayout layout = atlas_layout(model, factor);
  if (std::max(layout.width(), layout.height()) > max_texture_side) {
    throw bad_input("cmf maps",
                    fmt::format("{} x {} texels; a texture of the GPU holds {} a side",
                                layout.width(), layout.height(), max_texture_side),
                    "cluster them, or lower `resolution`");
  }
  const RgbArray& maps = model.factors[factor].maps;
  return rgb_texture("btf_" + name_of(model.factors[factor].projection), layout.width(),
                     layout.height(), to_atlas(maps.bytes, layout), to_atlas(maps.floats, layout));
}

constexpr const char* taps_glsl = R"(
struct btf_Taps { ivec2 texel; vec2 blend; };

btf_Taps btf_parabolic_taps(vec3 direction) {
  vec2 p = direction.xy / (1.0 + direction.z);
  float last = float(btf_resolution - 1);
  vec2 at = clamp(vec2(p.x + 1.0, 1.0 - p.y) * 0.5 * last, 0.0, last);
  ivec2 texel = min(ivec2(at), ivec2(btf_resolution - 2));
  return btf_Taps(texel, at - vec2(texel));
}

vec3 btf_map(sampler2D maps, ivec2 origin, btf_Taps taps) {
  ivec2 at = origin + taps.texel;
  vec2 a = taps.blend;
  return texelFetch(maps, at, 0).rgb * ((1.0 - a.x) * (1.0 - a.y)) +
         texelFetch(maps, at + ivec2(1, 0), 0).rgb * (a.x * (1.0 - a.y)) +
         texelFetch(maps, at + ivec2(0, 1), 0).rgb * ((1.0 - a.x) * a.y) +
         texelFetch(maps, at + ivec2(1, 1), 0).rgb * (a.x * a.y);
}
)";

constexpr const char* evaluate_glsl = R"(
vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {{
  if (!(light.z > 0.0) || !(view.z > 0.0)) return vec3(0.0);
  btf_TexelStencil texels = btf_bilinear_texels(uv, btf_size);
{taps}
  vec3 sum = vec3(0.0);
  for (int t = 0; t < 4; ++t) {{
    ivec2 texel = texels.texel[t];
{product}    vec3 scale = texelFetch(btf_scale, texel, 0).rgb;
    sum += product * {scale} * texels.weight[t];
  }}
  return sum * vec3({scale_r}, {scale_g}, {scale_b}) * light.z;
}}
)";

std::string direction_glsl(Projection projection) {
  return projection == Projection::half ? "normalize(light + view)" : name_of(projection);
}

// A float written so that GLSL reads the same one.
std::string literal(float value) {
  return fmt::format("{:.9e}", value);
}

}  // namespace

GlProgram CmfRepresentation::gl_program() const {
  GlProgram program;
  std::string taps;
  std::string product = "    vec3 product = vec3(1.0);\n";
  if (model_.clustered) {
    program.textures.push_back(image_texture("btf_index", Format::rgb8ui, model_.width,
                                             model_.height,
                                             std::as_bytes(std::span(model_.index))));
    product += "    ivec3 map = ivec3(texelFetch(btf_index, texel, 0).rgb);\n";
  }
  for (std::size_t f = 0; f < model_.factors.size(); ++f) {
    program.textures.push_back(maps_texture(model_, f));
    const std::string name = name_of(model_.factors[f].projection);
    taps += fmt::format("  btf_Taps {}_taps = btf_parabolic_taps({});\n", name,
                        direction_glsl(model_.factors[f].projection));
    const int columns = atlas_layout(model_, f).columns;
    const std::string cell = model_.clustered
                                 ? fmt::format("ivec2(map[{0}] % {1}, map[{0}] / {1})", f, columns)
                                 : std::string("texel");
    product += fmt::format("    product *= btf_map(btf_{0}, {1} * btf_resolution, {0}_taps);\n",
                           name, cell);
  }
  program.textures.push_back(rgb_texture("btf_scale", model_.width, model_.height,
                                         model_.scale.bytes, model_.scale.floats));
  program.glsl =
      texel_stencil_glsl() +
      fmt::format("\nconst ivec2 btf_size = ivec2({}, {});\nconst int btf_resolution = {};\n",
                  model_.width, model_.height, model_.resolution) +
      taps_glsl +
      fmt::format(fmt::runtime(evaluate_glsl), fmt::arg("taps", taps), fmt::arg("product", product),
                  fmt::arg("scale", model_.scale.floats.empty() ? "scale * scale" : "scale"),
                  fmt::arg("scale_r", literal(model_.scale_max.x)),
                  fmt::arg("scale_g", literal(model_.scale_max.y)),
                  fmt::arg("scale_b", literal(model_.scale_max.z)));
  return program;
}

}  // namespace weft::cmf
