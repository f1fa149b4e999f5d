// The GLSL of the stencils. Each function follows its C++ original line by line, so that both round
// alike.

#include "codecs/stencil_glsl.h"

#include <array>
#include <string_view>

namespace weft {

namespace {

constexpr std::string_view texel_stencil = R"(
struct btf_TexelStencil { ivec2 texel[4]; float weight[4]; };

btf_TexelStencil btf_bilinear_texels(vec2 uv, ivec2 size) {
  vec2 repeated = uv - floor(uv);
  vec2 p = vec2(repeated.x, 1.0 - repeated.y) * vec2(size) - 0.5;
  vec2 base = floor(p);
  vec2 a = p - base;
  ivec2 low = ivec2(base);
  ivec2 high = low + 1;
  low = ivec2(low.x < 0 ? low.x + size.x : low.x, low.y < 0 ? low.y + size.y : low.y);
  high = ivec2(high.x >= size.x ? high.x - size.x : high.x, high.y >= size.y ? high.y - size.y : high.y);
  return btf_TexelStencil(
      ivec2[4](low, ivec2(high.x, low.y), ivec2(low.x, high.y), high),
      float[4]((1.0 - a.x) * (1.0 - a.y), a.x * (1.0 - a.y), (1.0 - a.x) * a.y, a.x * a.y));
}
)";

constexpr std::string_view direction_stencil = R"(
struct btf_Stencil { ivec3 index; vec3 weight; };
float btf_cross(vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; }
)";

// $ is the prefix, #POINTS, #TRIANGLES, #HULL, #GRID numbers of the sampling.
constexpr std::string_view locate_by_triangles = R"(
vec2 $_point(int i) { return texelFetch($_points, i).xy; }
int $_hull_point(int i) { return int(texelFetch($_hull, i).r); }

btf_Stencil $_hold(int edge, vec2 p) {
  int last_turn = 0;
  for (int step = 0; step < #HULL; ++step) {
    int a = $_hull_point(edge);
    int b = $_hull_point((edge + 1) % #HULL);
    vec2 start = $_point(a);
    vec2 along = $_point(b) - start;
    float s = dot(p - start, along) / dot(along, along);
    int turn = s < 0.0 ? -1 : s > 1.0 ? 1 : 0;
    if (turn == 0 || turn == -last_turn) {
      float w = clamp(s, 0.0, 1.0);
      return btf_Stencil(ivec3(a, b, a), vec3(1.0 - w, w, 0.0));
    }
    last_turn = turn;
    edge = turn < 0 ? (edge + #HULL - 1) % #HULL : (edge + 1) % #HULL;
  }
  int a = $_hull_point(edge);
  return btf_Stencil(ivec3(a), vec3(1.0, 0.0, 0.0));
}

btf_Stencil $_walk(vec2 p) {
  ivec2 cell = clamp(ivec2((p + 1.0) * (float(#GRID) / 2.0)), ivec2(0), ivec2(#GRID - 1));
  int triangle = int(texelFetch($_grid, cell.y * #GRID + cell.x).r);
  ivec3 t = ivec3(0);
  vec3 weight = vec3(1.0, 0.0, 0.0);
  for (int step = 0; step <= #TRIANGLES; ++step) {
    t = ivec3(texelFetch($_triangles, 6 * triangle).r, texelFetch($_triangles, 6 * triangle + 1).r,
              texelFetch($_triangles, 6 * triangle + 2).r);
    vec2 a = $_point(t.x);
    vec2 b = $_point(t.y);
    vec2 c = $_point(t.z);
    weight = vec3(btf_cross(c - b, p - b), btf_cross(a - c, p - c), btf_cross(b - a, p - a));
    int side = 3;
    bool side_is_hull = false;
    for (int i = 0; i < 3; ++i) {
      if (weight[i] >= 0.0) continue;
      bool is_hull = (texelFetch($_triangles, 6 * triangle + 3 + i).r & #HULL_FLAGu) != 0u;
      bool first = side == 3 || (is_hull == side_is_hull ? weight[i] < weight[side] : side_is_hull);
      if (first) {
        side = i;
        side_is_hull = is_hull;
      }
    }
    if (side == 3) return btf_Stencil(t, weight / btf_cross(b - a, c - a));
    int next = int(texelFetch($_triangles, 6 * triangle + 3 + side).r);
    if (side_is_hull) return $_hold(next & ~#HULL_FLAG, p);
    triangle = next;
  }
  return btf_Stencil(t, vec3(1.0, 0.0, 0.0));
}

btf_Stencil $_locate(vec3 direction) {
  btf_Stencil stencil = $_walk(direction.xy / (1.0 + direction.z));
  // Points of the ring below the horizon hold zero.
  for (int i = 0; i < 3; ++i) {
    if (stencil.index[i] >= #POINTS) {
      stencil.index[i] = 0;
      stencil.weight[i] = 0.0;
    }
  }
  return stencil;
}
)";

constexpr std::string_view locate_nearest = R"(
btf_Stencil $_locate(vec3 direction) {
  int best = 0;
  float largest = -2.0;
  for (int i = 0; i < #POINTS; ++i) {
    float cosine = dot(texelFetch($_points, i).xyz, direction);
    if (cosine > largest) {
      largest = cosine;
      best = i;
    }
  }
  return btf_Stencil(ivec3(best), vec3(1.0, 0.0, 0.0));
}
)";

std::string replaced(std::string text, std::string_view what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

}  // namespace

std::string texel_stencil_glsl() {
  return std::string(texel_stencil);
}

std::string direction_stencil_glsl() {
  return std::string(direction_stencil);
}

GlProgram hemisphere_sampling_glsl(const HemisphereSampling& sampling, const std::string& prefix) {
  using Tables = HemisphereSampling::Tables;
  using Format = GlTexture::Format;
  const Tables& tables = sampling.tables();
  GlProgram program;
  const bool by_triangles = !tables.triangles.empty();
  program.glsl = by_triangles ? locate_by_triangles : locate_nearest;
  if (by_triangles) {
    program.textures.push_back(buffer_texture(prefix + "_points", Format::rg32f, tables.points));
    program.textures.push_back(
        buffer_texture(prefix + "_triangles", Format::r16ui, tables.triangles));
    program.textures.push_back(buffer_texture(prefix + "_grid", Format::r16ui, tables.grid));
    program.textures.push_back(buffer_texture(prefix + "_hull", Format::r16ui, tables.hull));
  } else {
    program.textures.push_back(
        buffer_texture(prefix + "_points", Format::rgb32f, sampling.directions()));
  }
  const std::array<std::pair<std::string_view, std::string>, 6> values{{
      {"$", prefix},
      {"#POINTS", std::to_string(sampling.size())},
      {"#TRIANGLES", std::to_string(tables.triangles.size())},
      {"#HULL_FLAG", std::to_string(Tables::hull_flag)},  // before #HULL, its prefix
      {"#HULL", std::to_string(tables.hull.size())},
      {"#GRID", std::to_string(HemisphereSampling::grid_size)},
  }};
  for (const auto& [name, value] : values) program.glsl = replaced(program.glsl, name, value);
  return program;
}

}  // namespace weft
