// The GLSL twin of Decoder::evaluate, and the textures that it fetches from.

#include <fmt/core.h>

#include <algorithm>
#include <numbers>

#include "btf/error.h"
#include "codecs/factor_maps/atlas.h"
#include "codecs/factor_maps/factor_map_representation.h"
#include "codecs/stencil_glsl.h"

namespace weft::factor_maps {

namespace {

using Format = GlTexture::Format;

constexpr int max_texture_side = 16384;

// Bytes of `values`, filled up with zeros to the texture's size.
template <typename Value>
GlTexture image_texture(std::string name, Format format, int width, int height,
                        const std::vector<Value>& values) {
  GlTexture texture{std::move(name), GlTexture::Kind::image_2d, format, width, height, 1, {}};
  const auto bytes = std::as_bytes(std::span(values));
  texture.bytes.assign(bytes.begin(), bytes.end());
  texture.bytes.resize(bytes_per_texel(format) * width * height);
  return texture;
}

GlTexture rgb_texture(std::string name, int width, int height,
                      const std::vector<std::uint8_t>& bytes, const std::vector<float>& floats) {
  return floats.empty() ? image_texture(std::move(name), Format::rgb8, width, height, bytes)
                        : image_texture(std::move(name), Format::rgb32f, width, height, floats);
}

GlTexture maps_texture(const Model& model, std::size_t factor) {
  const AtlasLayout layout = atlas_layout(model, factor);
  if (std::max(layout.width(), layout.height()) > max_texture_side) {
    throw bad_input(model.codec + " maps",
                    fmt::format("{} x {} texels; a texture of the GPU holds {} a side",
                                layout.width(), layout.height(), max_texture_side),
                    "cluster them, or lower `resolution`");
  }
  const ValueArray& maps = model.factors[factor].maps;
  return rgb_texture("btf_" + name_of(model.factors[factor].projection), layout.width(),
                     layout.height(), to_atlas(maps.bytes, layout), to_atlas(maps.floats, layout));
}

void add_texel_textures(const Model& model, GlProgram& program) {
  const int width = model.width();
  const int rows = texel_rows(model);
  for (std::size_t first = 0; model.clustered && first < model.index_channels(); first += 3) {
    std::vector<std::uint8_t> three(3 * model.texels());
    for (std::size_t i = 0; i < three.size(); ++i) {
      three[i] = model.index[model.index_channels() * (i / 3) + first + i % 3];
    }
    program.textures.push_back(image_texture(first == 0 ? "btf_index" : "btf_index_2",
                                             Format::rgb8ui, width, rows, three));
  }
  if (!model.rotation.empty()) {
    program.textures.push_back(
        image_texture("btf_rotation", Format::r8ui, width, rows, model.rotation));
  }
  program.textures.push_back(
      rgb_texture("btf_scale", width, rows, model.scale.bytes, model.scale.floats));
}

constexpr const char* lookup_glsl = R"(
struct btf_Taps { ivec2 texel; vec2 blend; };

btf_Taps btf_parabolic_taps(vec3 direction) {
  vec2 p = direction.xy / (1.0 + direction.z);
  float last = float(btf_resolution - 1);
  vec2 at = clamp(vec2(p.x + 1.0, 1.0 - p.y) * 0.5 * last, 0.0, last);
  ivec2 texel = min(ivec2(at), ivec2(btf_resolution - 2));
  return btf_Taps(texel, at - vec2(texel));
}

vec3 btf_map(sampler2D maps, ivec2 origin, btf_Taps taps) {
  ivec2 at = origin * btf_resolution + taps.texel;
  vec2 a = taps.blend;
  return texelFetch(maps, at, 0).rgb * ((1.0 - a.x) * (1.0 - a.y)) +
         texelFetch(maps, at + ivec2(1, 0), 0).rgb * (a.x * (1.0 - a.y)) +
         texelFetch(maps, at + ivec2(0, 1), 0).rgb * ((1.0 - a.x) * a.y) +
         texelFetch(maps, at + ivec2(1, 1), 0).rgb * (a.x * a.y);
}
)";

constexpr const char* difference_glsl = R"(
vec3 btf_difference_vector(vec3 light, vec3 view) {
  vec3 h = normalize(light + view);
  vec3 tangent = vec3(1.0, 0.0, 0.0) - h * h.x;
  if (length(tangent) < 1e-4) tangent = vec3(0.0, 0.0, 1.0) - h * h.z;
  tangent = normalize(tangent);
  return vec3(dot(light, tangent), dot(light, cross(h, tangent)), max(dot(light, h), 0.0));
}
)";

// {taps} stands before the loop over texels, or in it where each texel turns the directions.
constexpr const char* evaluate_glsl = R"(
vec3 btf_level(ivec3 level, vec2 uv, vec3 light, vec3 view) {{
  btf_TexelStencil texels = btf_bilinear_texels(uv, level.xy);
{shared_taps}  vec3 sum = vec3(0.0);
  for (int t = 0; t < 4; ++t) {{
    int i = level.z + texels.texel[t].y * level.x + texels.texel[t].x;
    ivec2 texel = ivec2(i % btf_levels[0].x, i / btf_levels[0].x);
{own_taps}    vec3 product = texelFetch(btf_scale, texel, 0).rgb;
{product}    sum += product * texels.weight[t];
  }}
  return sum;
}}

vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {{
  if (!(light.z > 0.0) || !(view.z > 0.0)) return vec3(0.0);
  float level = clamp(lod, 0.0, float(btf_levels.length() - 1));
  int fine = int(level);
  float blend = level - float(fine);
  vec3 value = btf_level(btf_levels[fine], uv, light, view);
  if (blend > 0.0) {{
    value = mix(value, btf_level(btf_levels[fine + 1], uv, light, view), blend);
  }}
  return value * vec3({scale_r}, {scale_g}, {scale_b}) * light.z;
}}
)";

constexpr const char* rotation_glsl =
    R"(    float angle = float(texelFetch(btf_rotation, texel, 0).r) * {};
    mat2 turn = mat2(cos(angle), sin(angle), -sin(angle), cos(angle));
    vec3 l = vec3(turn * light.xy, light.z);
    vec3 v = vec3(turn * view.xy, view.z);
)";

std::string direction_glsl(Projection projection, const std::string& light,
                           const std::string& view) {
  switch (projection) {
    case Projection::light:
      return light;
    case Projection::half:
      return fmt::format("normalize({} + {})", light, view);
    case Projection::difference:
      return fmt::format("btf_difference_vector({}, {})", light, view);
    case Projection::view:
      return view;
  }
  return "";
}

std::string taps_glsl(const Model& model, const std::string& light, const std::string& view) {
  std::string text;
  for (const Factor& factor : model.factors) {
    text += fmt::format("  btf_Taps {}_taps = btf_parabolic_taps({});\n",
                        name_of(factor.projection), direction_glsl(factor.projection, light, view));
  }
  return text;
}

// Where a texel's maps begin in each factor's atlas, in maps.
std::string origins_glsl(const Model& model) {
  std::string text;
  for (std::size_t f = 0; f < model.factors.size(); ++f) {
    const AtlasLayout layout = atlas_layout(model, f);
    const std::string name = name_of(model.factors[f].projection);
    const std::string map =
        model.clustered
            ? fmt::format("int(texelFetch(btf_index{}, texel, 0)[{}])", f < 3 ? "" : "_2", f % 3)
            : std::string("i");
    text += fmt::format(
        "    int {0}_map = {1};\n"
        "    ivec2 {0}_origin = ivec2({0}_map % {2}, ({0}_map / {2}) * {3});\n",
        name, map, layout.columns, layout.terms);
  }
  return text;
}

// The link's sum over terms, unrolled.
std::string link_glsl(const Model& model, int link) {
  std::string sum;
  int terms = 1;
  for (int term = 0; term < terms; ++term) {
    std::string product;
    for (const Factor& factor : model.factors) {
      if (link_of(factor.projection) != link) continue;
      terms = factor.terms;
      product += fmt::format("{0}btf_map(btf_{1}, {1}_origin + ivec2(0, {2}), {1}_taps)",
                             product.empty() ? "" : " * ", name_of(factor.projection), term);
    }
    if (product.empty()) return "";
    sum += (sum.empty() ? "" : " + ") + product;
  }
  return terms == 1 ? fmt::format("    product *= {};\n", sum)
                    : fmt::format("    product *= max(vec3(0.0), {});\n", sum);
}

std::string level_table(const Model& model) {
  std::string rows;
  for (const Level& level : model.levels) {
    rows += fmt::format("{}ivec3({}, {}, {})", rows.empty() ? "" : ", ", level.width, level.height,
                        level.first);
  }
  return fmt::format("const ivec3 btf_levels[{0}] = ivec3[{0}]({1});\n", model.levels.size(), rows);
}

// A float written so that GLSL reads the same one.
std::string literal(float value) {
  return fmt::format("{:.9e}", value);
}

}  // namespace

GlProgram FactorMapRepresentation::gl_program() const {
  GlProgram program;
  for (std::size_t f = 0; f < model_.factors.size(); ++f) {
    program.textures.push_back(maps_texture(model_, f));
  }
  add_texel_textures(model_, program);
  const bool rotated = !model_.rotation.empty();
  std::string own = origins_glsl(model_);
  if (rotated) {
    own += fmt::format(fmt::runtime(rotation_glsl),
                       literal(-2 * std::numbers::pi_v<float> / rotation_steps)) +
           taps_glsl(model_, "l", "v");
  }
  std::string product = model_.scale.floats.empty() ? "    product *= product;\n" : "";
  for (int link = 0; link < link_count; ++link) product += link_glsl(model_, link);
  const bool has_difference = std::ranges::any_of(model_.factors, [](const Factor& factor) {
    return factor.projection == Projection::difference;
  });
  program.glsl =
      texel_stencil_glsl() +
      fmt::format("\nconst int btf_resolution = {};\n{}", model_.resolution, level_table(model_)) +
      lookup_glsl + (has_difference ? difference_glsl : "") +
      fmt::format(
          fmt::runtime(evaluate_glsl),
          fmt::arg("shared_taps", rotated ? std::string() : taps_glsl(model_, "light", "view")),
          fmt::arg("own_taps", own), fmt::arg("product", product),
          fmt::arg("scale_r", literal(model_.scale_max.x)),
          fmt::arg("scale_g", literal(model_.scale_max.y)),
          fmt::arg("scale_b", literal(model_.scale_max.z)));
  return program;
}

}  // namespace weft::factor_maps
