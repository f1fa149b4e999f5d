// What the harness uploads and decodes, where the answer is known: formats, kinds, limits,
// failures.

#include "gl_preview/gpu_decode.h"

#include <cstring>

#include "gl_preview/gpu_appearance.h"
#include "gl_preview/tabulated_material.h"
#include "tests/gl_preview/gl_or_skip.h"
#include "tests/gl_preview/plain_appearance.h"
#include "tests/gl_preview/random_queries.h"

using namespace weft;

namespace {

std::vector<AppearanceQuery> some_queries(std::size_t count) {
  std::vector<AppearanceQuery> queries;
  for (std::size_t i = 0; i < count; ++i) queries.push_back(random_query(i, 0));
  return queries;
}

template <typename T>
std::vector<std::byte> bytes_of(const std::vector<T>& values) {
  std::vector<std::byte> bytes(values.size() * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

std::string message_of(const auto& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

constexpr AppearanceQuery upright{{0.5F, 0.5F}, {0, 0, 1}, {0, 0, 1}, 0};

}  // namespace

TEST_CASE("A tabulated Lambert material is exact on the GPU") {
  const auto context = gl_or_skip();
  if (!context) return;
  const LambertAppearance lambert(Rgb(0.8F, 0.4F, 0.1F));
  const auto queries = some_queries(10000);
  const auto found = decode_on_gpu(tabulated_program(lambert), queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Rgb expected = lambert.evaluate(queries[i].uv, queries[i].light, queries[i].view, 0);
    REQUIRE((found[i] - expected).length() < 1e-6F);
  }
}

TEST_CASE("A tabulated glossy material is close to itself on the GPU") {
  const auto context = gl_or_skip();
  if (!context) return;
  for (const float alpha : {0.1F, 0.3F}) {
    const GlossyAppearance glossy(alpha);
    const auto queries = some_queries(10000);
    const auto found = decode_on_gpu(tabulated_program(glossy), queries);
    double worst = 0;
    double sum = 0;
    double reference = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const Rgb expected = glossy.evaluate(queries[i].uv, queries[i].light, queries[i].view, 0);
      worst = std::max<double>(worst, max_component(found[i]) - max_component(expected));
      sum += std::abs(mean(found[i]) - mean(expected));
      reference += mean(expected);
    }
    INFO("alpha " << alpha << ": worst " << worst << ", mean " << sum / reference);
    CHECK(worst < 0.01);
    CHECK(sum / reference < 0.005);
  }
}

TEST_CASE("Texels arrive unchanged in every kind and format") {
  const auto context = gl_or_skip();
  if (!context) return;
  GlProgram program;
  program.textures = {
      {"btf_a", GlTexture::Kind::buffer, GlTexture::Format::r32f, 3, 1, 1,
       bytes_of<float>({1, 2.5F, 4})},
      // 3 bytes a row: rows are not padded to four.
      {"btf_b", GlTexture::Kind::image_2d, GlTexture::Format::r8ui, 3, 2, 1,
       bytes_of<std::uint8_t>({1, 2, 3, 4, 5, 6})},
      {"btf_c", GlTexture::Kind::array_2d, GlTexture::Format::rgb8, 1, 1, 3,
       bytes_of<std::uint8_t>({0, 0, 0, 0, 0, 0, 255, 51, 0})},
      {"btf_d", GlTexture::Kind::buffer, GlTexture::Format::r16f, 2, 1, 1,
       bytes_of<half>({half(0.5F), half(-3.0F)})},
      {"btf_e", GlTexture::Kind::buffer, GlTexture::Format::r32ui, 1, 1, 1,
       bytes_of<std::uint32_t>({70000})},
      {"btf_f", GlTexture::Kind::array_2d, GlTexture::Format::rgba16f, 1, 1, 1,
       bytes_of<half>({half(0.0F), half(0.0F), half(0.0F), half(9.0F)})},
      {"btf_g", GlTexture::Kind::image_2d, GlTexture::Format::rg32f, 1, 1, 1,
       bytes_of<float>({0, 1e-20F})},
  };
  program.glsl = R"(
    vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {
      if (lod == 0.0) {
        return vec3(texelFetch(btf_a, 2).r, texelFetch(btf_b, ivec2(1, 1), 0).r,
                    texelFetch(btf_c, ivec3(0, 0, 2), 0).g);
      }
      if (lod == 1.0) {
        return vec3(texelFetch(btf_d, 1).r, texelFetch(btf_e, 0).r, texelFetch(btf_f, ivec3(0), 0).a);
      }
      return vec3(texelFetch(btf_g, ivec2(0), 0).g, uv.x, view.y);
    })";
  std::vector<AppearanceQuery> queries(3, upright);
  queries[1].lod = 1;
  queries[2] = {{-1.25F, 0}, {0, 0, 1}, {0, 0.6F, 0.8F}, 2};
  const auto found = decode_on_gpu(program, queries);
  CHECK(found[0].equalWithAbsError(Rgb(4, 5, 0.2F), 1e-7F));
  CHECK(found[1] == Rgb(-3, 70000, 9));
  CHECK(found[2] == Rgb(1e-20F, -1.25F, 0.6F));
  CHECK(GpuAppearance(program, "it").bytes() == 12 + 6 + 9 + 4 + 4 + 8 + 8);
}

TEST_CASE("What a GPU cannot take is refused in one sentence that names it") {
  const auto context = gl_or_skip();
  if (!context) return;
  const auto refusal = [](GlTexture texture, const std::string& glsl) {
    const auto texels = static_cast<std::size_t>(texture.width) * texture.height * texture.layers;
    if (texture.bytes.empty()) texture.bytes.resize(texels * bytes_per_texel(texture.format));
    GlProgram program;
    program.textures.push_back(std::move(texture));
    program.glsl = glsl;
    return message_of([&] { decode_on_gpu(program, std::vector{upright}); });
  };
  const std::string black =
      "vec3 btf_evaluate(vec2 uv, vec3 l, vec3 v, float lod) { return vec3(0); }";
  using Kind = GlTexture::Kind;
  using Format = GlTexture::Format;
  CHECK_THAT(
      refusal({"btf_wide", Kind::image_2d, Format::r8, 1 << 20, 1, 1, {}}, black),
      Catch::Contains("btf_wide") && Catch::Contains("texels a row") && Catch::Contains("at most"));
  CHECK_THAT(refusal({"btf_deep", Kind::array_2d, Format::r8, 1, 1, 1 << 20, {}}, black),
             Catch::Contains("btf_deep") && Catch::Contains("1048576 layers"));
  CHECK_THAT(
      refusal({"btf_short", Kind::buffer, Format::r32f, 2, 1, 1, std::vector<std::byte>(7)}, black),
      Catch::Contains("7 bytes where 8"));
  CHECK_THAT(refusal({"btf_rgb", Kind::buffer, Format::rgb8, 2, 1, 1, {}}, black),
             Catch::Contains("three-component"));
  CHECK_THAT(refusal({"btf_good", Kind::buffer, Format::r8, 1, 1, 1, {}}, "vec3 btf_evaluate("),
             Catch::Contains("does not compile"));
  CHECK_THAT(refusal({"btf_good", Kind::buffer, Format::r8, 1, 1, 1, {}}, black),
             Catch::Equals("no error"));
}

TEST_CASE("An OpenGL error becomes an exception once, with the driver's words") {
  const auto context = gl_or_skip();
  if (!context) return;
  glEnable(0x1234);
  CHECK_THAT(message_of([] { check_gl("testing"); }),
             Catch::Contains("testing") && Catch::Contains("glEnable"));
  CHECK(message_of([] { check_gl("testing"); }) == "no error");
}
