#include "codecs/raw/raw_representation.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "btf/btf_file.h"
#include "btf/error.h"
#include "btf/sample_blend.h"
#include "codecs/raw/raw.h"
#include "codecs/sample_check.h"
#include "codecs/stencil_glsl.h"

namespace weft {

namespace {

// Of every driver met so far, Mesa's and the vendors' alike.
constexpr std::size_t max_buffer_texels = 134'217'728;

// How a sample lies in the texture buffer. There is no three-channel half format for buffers: three
// single texels are the smaller way, a padded one the way with fewer texels.
struct SampleLayout {
  GlTexture::Format format;
  std::size_t texels_a_sample;
  const char* fetch;

  std::size_t bytes_a_sample() const { return texels_a_sample * bytes_per_texel(format); }
};

constexpr SampleLayout three_halfs{
    GlTexture::Format::r16f, 3,
    "vec3(texelFetch(btf_values, 3 * i).r, texelFetch(btf_values, 3 * i + 1).r,\n"
    "              texelFetch(btf_values, 3 * i + 2).r)"};
constexpr SampleLayout padded_halfs{GlTexture::Format::rgba16f, 1, "texelFetch(btf_values, i).rgb"};
constexpr SampleLayout floats{GlTexture::Format::rgb32f, 1, "texelFetch(btf_values, i).rgb"};

SampleLayout layout_of(PixelType type, std::size_t samples) {
  if (type == PixelType::float32) return floats;
  return 3 * samples <= max_buffer_texels ? three_halfs : padded_halfs;
}

// Of all mip levels, as `next_mip_level` makes them.
std::size_t sample_count(int width, int height, std::size_t pairs) {
  std::size_t texels = static_cast<std::size_t>(width) * height;
  while (width > 1 || height > 1) {
    width = std::max(1, width / 2);
    height = std::max(1, height / 2);
    texels += static_cast<std::size_t>(width) * height;
  }
  return texels * pairs;
}

std::size_t sample_count(const Btf& finest) {
  return sample_count(finest.width(), finest.height(),
                      finest.views().size() * finest.lights().size());
}

void append(std::vector<std::byte>& bytes, const Btf& level, const SampleLayout& layout) {
  if (layout.format == GlTexture::Format::rgba16f) {
    const auto values = level.halfs();
    for (std::size_t i = 0; i < values.size(); i += 3) {
      const half padded[4] = {values[i], values[i + 1], values[i + 2], half(0)};
      const auto texel = std::as_bytes(std::span(padded));
      bytes.insert(bytes.end(), texel.begin(), texel.end());
    }
    return;
  }
  const auto values = level.pixel_type() == PixelType::half ? std::as_bytes(level.halfs())
                                                            : std::as_bytes(level.floats());
  bytes.insert(bytes.end(), values.begin(), values.end());
}

GlTexture values_texture(const RawAppearance& appearance) {
  const std::size_t samples = sample_count(*appearance.levels()[0]);
  const SampleLayout layout = layout_of(appearance.levels()[0]->pixel_type(), samples);
  if (samples * layout.texels_a_sample > max_buffer_texels) {
    throw bad_input(
        "raw BTF",
        fmt::format("{} samples with its mip levels; a texture buffer of the GPU holds {}", samples,
                    max_buffer_texels),
        "preview a compressed one (weft compress), or acquire fewer texels or directions");
  }
  GlTexture texture{"btf_values", GlTexture::Kind::buffer, layout.format, 0, 1, 1, {}};
  texture.bytes.reserve(samples * layout.bytes_a_sample());
  for (const auto& level : appearance.levels()) append(texture.bytes, *level, layout);
  texture.width = static_cast<int>(samples * layout.texels_a_sample);
  return texture;
}

// Each level's width, height and first sample.
std::string level_table(const RawAppearance& appearance) {
  std::string rows;
  std::size_t first = 0;
  for (const auto& level : appearance.levels()) {
    rows += fmt::format("{}ivec3({}, {}, {})", rows.empty() ? "" : ", ", level->width(),
                        level->height(), first);
    first += static_cast<std::size_t>(level->width()) * level->height() * level->views().size() *
             level->lights().size();
  }
  const std::size_t n = appearance.levels().size();
  return fmt::format("const ivec3 btf_levels[{0}] = ivec3[{0}]({1});\n", n, rows);
}

constexpr const char* evaluate_glsl = R"(
vec3 btf_level(ivec3 level, vec2 uv, btf_Stencil view, ivec3 light, vec3 light_weight) {
  btf_TexelStencil texels = btf_bilinear_texels(uv, level.xy);
  vec3 sum = vec3(0.0);
  for (int t = 0; t < 4; ++t) {
    int abrdf = level.z + (texels.texel[t].y * level.x + texels.texel[t].x) * btf_n_views * btf_n_lights;
    vec3 value = vec3(0.0);
    for (int v = 0; v < 3; ++v) {
      if (view.weight[v] == 0.0) continue;
      int row = abrdf + view.index[v] * btf_n_lights;
      for (int l = 0; l < 3; ++l) value += btf_sample(row + light[l]) * (view.weight[v] * light_weight[l]);
    }
    sum += value * texels.weight[t];
  }
  return sum;
}

vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {
  if (!(light.z > 0.0) || !(view.z > 0.0)) return vec3(0.0);
  btf_Stencil views = btf_views_locate(view);
  btf_Stencil lights = btf_lights_locate(light);
  vec3 light_weight;
  for (int i = 0; i < 3; ++i) {
    light_weight[i] = lights.weight[i] * texelFetch(btf_inverse_cosines, lights.index[i]).r * light.z;
  }
  float level = clamp(lod, 0.0, float(btf_levels.length() - 1));
  int fine = int(level);
  float blend = level - float(fine);
  vec3 value = btf_level(btf_levels[fine], uv, views, lights.index, light_weight);
  if (blend > 0.0) {
    value = mix(value, btf_level(btf_levels[fine + 1], uv, views, lights.index, light_weight), blend);
  }
  return value;
}
)";

// At each lane's level. Nothing is gained by asking for samples ahead: the CPU finds the next
// lanes' by itself (measured).
Batch<Rgb> blended_in_batch(const std::vector<std::shared_ptr<const Btf>>& levels,
                            const Batch<std::int32_t>& level, const QueryBatch& batch,
                            const Batch<PairLane>& pairs) {
  const TexelBatch texels = level_texel_batch(batch, level, [&](std::int32_t l) {
    return std::pair(levels[l]->width(), levels[l]->height());
  });
  Batch<Rgb> values;
  if (std::ranges::any_of(level, [&](std::int32_t l) { return l != level[0]; })) {
    for (std::size_t i = 0; i < batch_lanes; ++i)
      values[i] = blended(*levels[level[i]], texels.lane(i), pairs[i]);
    return values;
  }
  with_sample_blend(*levels[level[0]], [&](const auto& blend) {
    for (std::size_t i = 0; i < batch_lanes; ++i) values[i] = blend(texels.lane(i), pairs[i]);
  });
  return values;
}

}  // namespace

RawRepresentation::RawRepresentation(std::shared_ptr<const Btf> btf)
    : appearance_(std::move(btf)),
      view_locator_(views()),
      light_locator_(lights()),
      inverse_cosines_(inverse_cosines(lights())) {}

void RawRepresentation::evaluate(std::span<const AppearanceQuery> queries,
                                 std::span<Rgb> answers) const {
  decode_in_batches(queries, answers, [this](const QueryBatch& batch) { return decode(batch); });
}

Batch<Rgb> RawRepresentation::decode(const QueryBatch& batch) const {
  const Batch<PairLane> pairs =
      pair_batch(view_locator_.locate(views(), batch.view),
                 light_locator_.locate(lights(), batch.light), inverse_cosines_, batch.light.z);
  const auto& levels = appearance_.levels();
  const LevelBatch level = level_batch(batch.lod, levels.size());
  const Batch<Rgb> fine = blended_in_batch(levels, level.fine, batch, pairs);
  if (std::ranges::max(level.blend) == 0) return fine;
  const Batch<Rgb> coarse = blended_in_batch(levels, level.coarse, batch, pairs);
  Batch<Rgb> values;
  for (std::size_t i = 0; i < batch_lanes; ++i)
    values[i] = fine[i] * (1 - level.blend[i]) + coarse[i] * level.blend[i];
  return values;
}

std::size_t raw_texture_bytes(int width, int height, std::size_t pairs, PixelType type) {
  const std::size_t samples = sample_count(width, height, pairs);
  return samples * layout_of(type, samples).bytes_a_sample();
}

std::size_t RawRepresentation::bytes() const {
  return raw_texture_bytes(btf().width(), btf().height(), views().size() * lights().size(),
                           btf().pixel_type());
}

std::size_t RawRepresentation::constant_bytes() const {
  std::size_t bytes = lights().size() * sizeof(float);
  for (const HemisphereSampling* sampling : {&views(), &lights()}) {
    for (const GlTexture& table : hemisphere_sampling_glsl(*sampling, "btf_any").textures) {
      bytes += table.bytes.size();
    }
  }
  return bytes;
}

void RawRepresentation::save(const std::filesystem::path& folder) const {
  write_btf(folder, btf());
}

GlProgram RawRepresentation::gl_program() const {
  GlProgram program;
  program.textures.push_back(values_texture(appearance_));
  program.textures.push_back(
      buffer_texture("btf_inverse_cosines", GlTexture::Format::r32f, inverse_cosines(lights())));
  program.glsl = texel_stencil_glsl() + direction_stencil_glsl();
  for (const auto& [sampling, prefix] :
       {std::pair(&lights(), "btf_lights"), std::pair(&views(), "btf_views")}) {
    GlProgram part = hemisphere_sampling_glsl(*sampling, prefix);
    program.glsl += part.glsl;
    for (GlTexture& table : part.textures) program.textures.push_back(std::move(table));
  }
  const SampleLayout layout = layout_of(btf().pixel_type(), sample_count(btf()));
  program.glsl += fmt::format("\nconst int btf_n_views = {};\nconst int btf_n_lights = {};\n{}",
                              views().size(), lights().size(), level_table(appearance_));
  program.glsl += fmt::format("vec3 btf_sample(int i) {{\n  return {};\n}}\n", layout.fetch);
  program.glsl += evaluate_glsl;
  return program;
}

Codec raw_codec() {
  return {
      .name = "raw",
      .summary = "the data itself, interpolated over texels, directions and mip levels",
      .reference = "docs/codecs/raw.md",
      .parameters = "",
      .fit = [](std::shared_ptr<const Btf> btf, const Settings& parameters,
                Progress&) -> std::unique_ptr<Representation> {
        parameters.finish();
        refuse_invalid_samples(*btf);
        return std::make_unique<RawRepresentation>(std::move(btf));
      },
      .load = [](const std::filesystem::path& folder) -> std::unique_ptr<Representation> {
        return std::make_unique<RawRepresentation>(std::make_shared<const Btf>(read_btf(folder)));
      }};
}

}  // namespace weft
