// Compiling and linking GLSL.

#include "gl_preview/gl_shader.h"

#include <vector>

#include "btf/error.h"
#include "gl_preview/gl_context.h"

namespace weft {

namespace {

constexpr std::size_t shown_log = 2000;

template <GLenum Stage>
GlShader<Stage> compile(const std::string& name, const std::string& source) {
  auto shader = GlShader<Stage>::make();
  const GLchar* text = source.c_str();
  const auto length = static_cast<GLint>(source.size());
  glShaderSource(shader.name(), 1, &text, &length);
  glCompileShader(shader.name());
  GLint ok = GL_FALSE;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &ok);
  if (ok == GL_FALSE) {
    GLint size = 0;
    glGetShaderiv(shader.name(), GL_INFO_LOG_LENGTH, &size);
    std::vector<GLchar> log(static_cast<std::size_t>(size) + 1, '\0');
    glGetShaderInfoLog(shader.name(), size, nullptr, log.data());
    throw failed(name,
                 "its GLSL does not compile: " + std::string(log.data()).substr(0, shown_log));
  }
  return shader;
}

template <typename... Shaders>
GlLinkedProgram link(const std::string& name, const Shaders&... shaders) {
  auto program = GlLinkedProgram::make();
  (glAttachShader(program.name(), shaders.name()), ...);
  glLinkProgram(program.name());
  GLint ok = GL_FALSE;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &ok);
  if (ok == GL_FALSE) {
    GLint size = 0;
    glGetProgramiv(program.name(), GL_INFO_LOG_LENGTH, &size);
    std::vector<GLchar> log(static_cast<std::size_t>(size) + 1, '\0');
    glGetProgramInfoLog(program.name(), size, nullptr, log.data());
    throw failed(name, "its GLSL does not link: " + std::string(log.data()).substr(0, shown_log));
  }
  (glDetachShader(program.name(), shaders.name()), ...);
  check_gl(name);
  return program;
}

}  // namespace

GlLinkedProgram link_graphics_program(const std::string& name, const std::string& vertex,
                                      const std::string& fragment) {
  return link(name, compile<GL_VERTEX_SHADER>(name, vertex),
              compile<GL_FRAGMENT_SHADER>(name, fragment));
}

GlLinkedProgram link_compute_program(const std::string& name, const std::string& compute) {
  return link(name, compile<GL_COMPUTE_SHADER>(name, compute));
}

std::string full_screen_vertex_shader() {
  return R"(#version 450 core
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)";
}

}  // namespace weft
