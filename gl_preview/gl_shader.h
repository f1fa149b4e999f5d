// Shader programs from text, with the compiler's own words where they fail.
#pragma once

#include <string>

#include "gl_preview/gl_object.h"

namespace weft {

/// @param name  what the program is for; part of the message.
/// @throws Error failed, with the compiler's or linker's log.
GlLinkedProgram link_graphics_program(const std::string& name, const std::string& vertex,
                                      const std::string& fragment);
GlLinkedProgram link_compute_program(const std::string& name, const std::string& compute);

/// One triangle over the whole picture, at depth 0; draw 3 vertices without attributes.
std::string full_screen_vertex_shader();

}  // namespace weft
