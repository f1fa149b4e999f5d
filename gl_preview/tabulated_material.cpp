// The table of a homogeneous material, and the GLSL that reads it.

#include "gl_preview/tabulated_material.h"

#include <fmt/core.h>

#include <cstring>

namespace weft {

namespace {

constexpr int half_steps = 96;
constexpr int diff_steps = 48;
/// phi_diff from 0 to pi/2: mirror symmetry and reciprocity fold the rest onto it.
constexpr int azimuth_steps = 16;
/// Entries of which a direction lies below the horizon take the value of one just above it, so that
/// the neighbours of the horizon don't darken.
constexpr float lowest_cosine = 0.01F;

Direction lifted(const Direction& d) {
  return d.z >= lowest_cosine ? d : Direction(d.x, d.y, lowest_cosine).normalized();
}

Rgb entry(const Appearance& material, float theta_half, float theta_diff, float phi_diff) {
  const Direction half(std::sin(theta_half), 0, std::cos(theta_half));
  const Direction diff = from_spherical(theta_diff, phi_diff);
  const Direction light(half.z * diff.x + half.x * diff.z, diff.y,
                        half.z * diff.z - half.x * diff.x);
  const Direction view = 2 * light.dot(half) * half - light;
  const Direction upper_light = lifted(light);
  return material.evaluate({0, 0}, upper_light, lifted(view), 0) / upper_light.z;
}

constexpr const char* glsl = R"(
vec3 btf_table(ivec3 at) {{
  return texelFetch(btf_brdf, (at.x * {diff} + at.y) * {azimuth} + at.z).rgb;
}}

vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {{
  if (light.z <= 0.0 || view.z <= 0.0) return vec3(0.0);
  const float half_pi = 1.57079632679;
  vec3 sum = light + view;
  vec3 middle = normalize(sum);
  float cos_diff = min(dot(light, middle), 1.0);
  float sin_half = length(middle.xy);
  vec2 azimuth = sin_half > 1e-7 ? middle.xy / sin_half : vec2(1.0, 0.0);
  // Difference vector: the light seen from the half vector as pole.
  float along = dot(light.xy, azimuth);
  float x = middle.z * along - sin_half * light.z;
  float y = azimuth.x * light.y - azimuth.y * light.x;
  float phi = abs(x) + abs(y) > 1e-7 ? atan(abs(y), abs(x)) : 0.0;
  vec3 p = vec3(sqrt(atan(sin_half, middle.z) / half_pi), acos(cos_diff) / half_pi, phi / half_pi);
  p = clamp(p, 0.0, 1.0) * vec3({half} - 1, {diff} - 1, {azimuth} - 1);
  ivec3 low = min(ivec3(p), ivec3({half} - 2, {diff} - 2, {azimuth} - 2));
  vec3 w = p - vec3(low);
  vec3 f = vec3(0.0);
  for (int corner = 0; corner < 8; ++corner) {{
    ivec3 step = ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
    vec3 weight = mix(1.0 - w, w, vec3(step));
    f += weight.x * weight.y * weight.z * btf_table(low + step);
  }}
  return f * light.z;
}}
)";

}  // namespace

GlProgram tabulated_program(const Appearance& material) {
  constexpr float half_pi = std::numbers::pi_v<float> / 2;
  std::vector<float> values;
  values.reserve(std::size_t{3} * half_steps * diff_steps * azimuth_steps);
  for (int h = 0; h < half_steps; ++h) {
    const float root = static_cast<float>(h) / (half_steps - 1);
    for (int d = 0; d < diff_steps; ++d) {
      const float theta_diff = half_pi * static_cast<float>(d) / (diff_steps - 1);
      for (int a = 0; a < azimuth_steps; ++a) {
        const float phi_diff = half_pi * static_cast<float>(a) / (azimuth_steps - 1);
        const Rgb f = entry(material, half_pi * root * root, theta_diff, phi_diff);
        values.insert(values.end(), {f.x, f.y, f.z});
      }
    }
  }
  GlTexture table;
  table.name = "btf_brdf";
  table.kind = GlTexture::Kind::buffer;
  table.format = GlTexture::Format::rgb32f;
  table.width = static_cast<int>(values.size() / 3);
  table.bytes.resize(values.size() * sizeof(float));
  std::memcpy(table.bytes.data(), values.data(), table.bytes.size());
  GlProgram program;
  program.glsl = fmt::format(fmt::runtime(glsl), fmt::arg("half", half_steps),
                             fmt::arg("diff", diff_steps), fmt::arg("azimuth", azimuth_steps));
  program.textures.push_back(std::move(table));
  return program;
}

}  // namespace weft
