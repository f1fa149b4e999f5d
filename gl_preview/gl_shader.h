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

}  // namespace weft
