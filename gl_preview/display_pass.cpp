// Full-screen passes.

#include "gl_preview/display_pass.h"

#include <cmath>
#include <string>

#include "gl_preview/gl_context.h"
#include "gl_preview/gl_shader.h"

namespace weft {

namespace {

constexpr const char* exposure_source = R"(#version 450 core
layout(binding = 0) uniform sampler2D picture;
layout(location = 0) uniform float gain;
layout(location = 0) out vec4 colour;
void main() {
  vec3 c = clamp(texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb * gain, 0.0, 1.0);
  vec3 encoded = mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
  colour = vec4(encoded, 1.0);
}
)";

/// Viridis as polynomials of degree 6 [Zucker, "Colormap polynomials", 2018].
constexpr const char* scale_source = R"(#version 450 core
vec3 viridis(float t) {
  const vec3 c0 = vec3(0.2777273272234177, 0.005407344544966578, 0.3340998053353061);
  const vec3 c1 = vec3(0.1050930431085774, 1.404613529898575, 1.384590162594685);
  const vec3 c2 = vec3(-0.3308618287255563, 0.214847559468213, 0.09509516302823659);
  const vec3 c3 = vec3(-4.634230498983486, -5.799100973351585, -19.33244095627987);
  const vec3 c4 = vec3(6.228269936347081, 14.17993336680509, 56.69055260068105);
  const vec3 c5 = vec3(4.776384997670288, -13.74514537774601, -65.35303263337234);
  const vec3 c6 = vec3(-5.435455855934631, 4.645852612178535, 26.3124352495832);
  return c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6)))));
}
layout(location = 0) out vec4 colour;
)";

constexpr const char* error_main = R"(
layout(binding = 0) uniform sampler2D reference;
layout(binding = 1) uniform sampler2D test;
layout(location = 0) uniform float full_scale;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 d = abs(texelFetch(test, at, 0).rgb - texelFetch(reference, at, 0).rgb);
  colour = vec4(viridis(clamp((d.r + d.g + d.b) / (3.0 * full_scale), 0.0, 1.0)), 1.0);
}
)";

constexpr const char* legend_main = R"(
layout(location = 0) uniform float width;
void main() { colour = vec4(viridis(gl_FragCoord.x / width), 1.0); }
)";

}  // namespace

DisplayPass::DisplayPass()
    : no_attributes_(GlVertexArray::make()),
      exposure_(
          link_graphics_program("exposure pass", full_screen_vertex_shader(), exposure_source)),
      error_(link_graphics_program("error map", full_screen_vertex_shader(),
                                   std::string(scale_source) + error_main)),
      legend_(link_graphics_program("legend", full_screen_vertex_shader(),
                                    std::string(scale_source) + legend_main)) {}

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
