// Every codec decodes on the GPU as it does on the CPU.

#include <algorithm>
#include <array>
#include <set>

#include "gl_preview/gpu_decode.h"
#include "tests/gl_preview/codec_variants.h"
#include "tests/gl_preview/gl_or_skip.h"
#include "tests/gl_preview/procedural_btf.h"
#include "tests/gl_preview/random_queries.h"

using namespace weft;

namespace {

constexpr std::size_t query_count = 10000;
constexpr float near_discontinuity = 1e-4F;

float largest_value(const Btf& btf) {
  float largest = 0;
  for (std::size_t v = 0; v < btf.views().size(); ++v) {
    for (std::size_t l = 0; l < btf.lights().size(); ++l) {
      for (int i = 0; i < btf.width() * btf.height(); ++i) {
        largest = std::max(largest, max_component(btf.at(l, v, i % btf.width(), i / btf.width())));
      }
    }
  }
  return largest;
}

float difference(const Rgb& a, const Rgb& b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

/// The query moved by `near_discontinuity` along one of its parameters.
std::vector<AppearanceQuery> neighbours(const AppearanceQuery& query) {
  std::vector<AppearanceQuery> result;
  for (const float step : {-near_discontinuity, near_discontinuity}) {
    for (int axis = 0; axis < 3; ++axis) {
      AppearanceQuery light = query;
      light.light[axis] += step;
      light.light.normalize();
      AppearanceQuery view = query;
      view.view[axis] += step;
      view.view.normalize();
      result.insert(result.end(), {light, view});
    }
    for (int axis = 0; axis < 2; ++axis) {
      AppearanceQuery texcoord = query;
      texcoord.uv[axis] += step;
      result.push_back(texcoord);
    }
    AppearanceQuery level = query;
    level.lod = std::max(0.0F, level.lod + step);
    result.push_back(level);
  }
  return result;
}

bool is_near_discontinuity(const Appearance& appearance, const AppearanceQuery& query, float jump) {
  const auto ask = [&](const AppearanceQuery& q) {
    return appearance.evaluate(q.uv, q.light, q.view, q.lod);
  };
  const Rgb here = ask(query);
  for (const AppearanceQuery& q : neighbours(query)) {
    if (difference(ask(q), here) > jump) return true;
  }
  return false;
}

/// Random queries; those near a discontinuity are drawn anew. `redrawn` counts them.
struct Drawn {
  std::vector<AppearanceQuery> queries;
  std::size_t redrawn = 0;
};

Drawn draw_queries(const Appearance& appearance, float jump) {
  Drawn drawn;
  for (std::uint64_t index = 0; drawn.queries.size() < query_count; ++index) {
    const float level = 5 * unit_float(hash_coordinates(17, index, 0)) - 1;
    const AppearanceQuery query = random_query(index, std::max(0.0F, level));
    if (is_near_discontinuity(appearance, query, jump)) {
      ++drawn.redrawn;
    } else {
      drawn.queries.push_back(query);
    }
  }
  return drawn;
}

void check_decoding(const FittedVariant& variant, float largest) {
  const bool is_8bit = variant.name.find("bits=8") != std::string::npos;
  const float allowed = largest * (is_8bit ? 1.0F / 255.0F : 1e-3F);
  const Drawn drawn = draw_queries(*variant.representation, allowed);
  const auto found = decode_on_gpu(variant.representation->gl_program(), drawn.queries);
  float worst = 0;
  std::size_t worst_at = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const AppearanceQuery& q = drawn.queries[i];
    const float d =
        difference(found[i], variant.representation->evaluate(q.uv, q.light, q.view, q.lod));
    // Not a number counts as the worst there is.
    if (d > worst || std::isnan(d)) {
      worst = std::isnan(d) ? 1e30F : d;
      worst_at = i;
    }
  }
  const AppearanceQuery& q = drawn.queries[worst_at];
  INFO(variant.name << ": worst " << worst / largest << " of the largest value at uv " << q.uv
                    << " light " << q.light << " view " << q.view << " lod " << q.lod << ", GPU "
                    << found[worst_at] << "; redrawn " << drawn.redrawn);
  CHECK(worst <= allowed);
  CHECK(drawn.redrawn < query_count / 20);
}

void check_variants(const std::shared_ptr<const Btf>& btf) {
  const float largest = largest_value(*btf);
  for (const FittedVariant& variant : fitted_variants(btf)) check_decoding(variant, largest);
}

/// How many maps of the codebook of each factor the index texture names.
std::array<std::size_t, 3> maps_in_use(const GlProgram& program) {
  const auto index = std::ranges::find(program.textures, "btf_index", &GlTexture::name);
  REQUIRE(index != program.textures.end());
  std::array<std::set<unsigned char>, 3> used;
  for (std::size_t i = 0; i < texel_count(*index) * 3; ++i)
    used[i % 3].insert(static_cast<unsigned char>(index->bytes[i]));
  return {used[0].size(), used[1].size(), used[2].size()};
}

}  // namespace

TEST_CASE("Every codec decodes on the GPU as on the CPU", "[heavy]") {
  const auto context = gl_or_skip();
  if (!context) return;
  check_variants(procedural_btf(8, 8, "ubo81", PixelType::half));
}

TEST_CASE("Odd sizes, few directions and floats decode alike too") {
  const auto context = gl_or_skip();
  if (!context) return;
  check_variants(procedural_btf(5, 3, "regular:3x8", PixelType::float32));
  check_variants(procedural_btf(1, 1, "fibonacci:40", PixelType::half));
}

TEST_CASE("Indices beyond half a codebook decode alike too") {
  const auto context = gl_or_skip();
  if (!context) return;
  // 400 texels and their levels: twice as many maps as a byte can name.
  const auto btf = procedural_btf(20, 20, "regular:3x8", PixelType::half);
  const std::vector<std::string> parameters{"bits=8", "resolution=8"};
  Progress silent;
  const FittedVariant variant{
      "cmf bits=8 resolution=8, 20 x 20 texels",
      codec_named("cmf").fit(btf, Settings::from_text("", "--set", parameters), silent)};
  for (const std::size_t count : maps_in_use(variant.representation->gl_program()))
    CHECK(count > 150);
  check_decoding(variant, largest_value(*btf));
}
