// Full-screen passes.

#include "gl_preview/display_pass.h"

#include <cmath>
#include <string>

#include "gl_preview/gl_context.h"
#include "gl_preview/gl_shader.h"

namespace weft {

namespace {

constexpr const char* srgb_source = R"(#version 450 core
vec3 srgb_encoded(vec3 c) {
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}
layout(location = 0) out vec4 colour;
)";

constexpr const char* exposure_main = R"(
layout(binding = 0) uniform sampler2D picture;
layout(location = 0) uniform float gain;
void main() {
  vec3 c = texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb * gain;
  colour = vec4(srgb_encoded(clamp(c, 0.0, 1.0)), 1.0);
}
)";

/// The scale of `weft compare`'s maps (study/colour_map.h): an arc of a helix in OKLab.
constexpr const char* scale_source = R"(
vec3 scale_colour(float t) {
  float angle = radians(-80.0 - 150.0 * t);
  vec3 lab = vec3(mix(0.25, 0.92, t), vec2(0.05, 0.06) + 0.16 * vec2(cos(angle), sin(angle)));
  vec3 cones = vec3(dot(lab, vec3(1.0, 0.3963377774, 0.2158037573)),
                    dot(lab, vec3(1.0, -0.1055613458, -0.0638541728)),
                    dot(lab, vec3(1.0, -0.0894841775, -1.2914855480)));
  cones = cones * cones * cones;
  vec3 linear = vec3(dot(cones, vec3(4.0767416621, -3.3077115913, 0.2309699292)),
                     dot(cones, vec3(-1.2684380046, 2.6097574011, -0.3413193965)),
                     dot(cones, vec3(-0.0041960863, -0.7034186147, 1.7076147010)));
  return srgb_encoded(clamp(linear, 0.0, 1.0));
}
)";

constexpr const char* error_main = R"(
layout(binding = 0) uniform sampler2D reference;
layout(binding = 1) uniform sampler2D test;
layout(location = 0) uniform float full_scale;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 d = abs(texelFetch(test, at, 0).rgb - texelFetch(reference, at, 0).rgb);
  colour = vec4(scale_colour(clamp((d.r + d.g + d.b) / (3.0 * full_scale), 0.0, 1.0)), 1.0);
}
)";

constexpr const char* legend_main = R"(
layout(location = 0) uniform float width;
void main() { colour = vec4(scale_colour(gl_FragCoord.x / width), 1.0); }
)";

}  // namespace

DisplayPass::DisplayPass()
    : no_attributes_(GlVertexArray::make()),
      exposure_(link_graphics_program("exposure pass", full_screen_vertex_shader(),
                                      std::string(srgb_source) + exposure_main)),
      error_(link_graphics_program("error map", full_screen_vertex_shader(),
                                   std::string(srgb_source) + scale_source + error_main)),
      legend_(link_graphics_program("legend", full_screen_vertex_shader(),
                                    std::string(srgb_source) + scale_source + legend_main)) {}

void DisplayPass::draw(const GlLinkedProgram& program, const RenderTarget& target) const {
  target.bind();
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_STENCIL_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glBindVertexArray(no_attributes_.name());
  glUseProgram(program.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  check_gl("display pass");
}

void DisplayPass::show(unsigned picture, float exposure, const RenderTarget& target) const {
  glBindTextureUnit(0, picture);
  glProgramUniform1f(exposure_.name(), 0, std::exp2(exposure));
  draw(exposure_, target);
}

void DisplayPass::show_error(unsigned reference, unsigned test, float full_scale,
                             const RenderTarget& target) const {
  glBindTextureUnit(0, reference);
  glBindTextureUnit(1, test);
  glProgramUniform1f(error_.name(), 0, full_scale);
  draw(error_, target);
}

void DisplayPass::show_legend(const RenderTarget& target) const {
  glProgramUniform1f(legend_.name(), 0, static_cast<float>(target.width()));
  draw(legend_, target);
}

}  // namespace weft
