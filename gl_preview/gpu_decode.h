// Answers queries on the GPU: the twin of Appearance::evaluate, for tests and for measuring codecs.
#pragma once

#include <span>
#include <vector>

#include "btf/appearance.h"
#include "codecs/gl_program.h"

namespace weft {

/// B of each query in 1/sr, decoded by `program`'s GLSL in a compute shader of the current context.
/// @throws Error failed, as `GpuAppearance` does.
std::vector<Rgb> decode_on_gpu(const GlProgram& program, std::span<const AppearanceQuery> queries);

}  // namespace weft
