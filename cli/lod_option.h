// `--lod`: a fixed level of detail, or each pixel's own.
#pragma once

#include <optional>
#include <string>

#include "tracer/scene.h"

namespace weft::cli {

/// @param text  a number >= 0, or "auto" (answers nothing). @throws Error bad_input
std::optional<float> parse_lod(const std::string& text);

/// Whether any material of a scene has levels of detail.
bool has_levels(const Scene& scene);

/// @param levels  whether what is drawn has any.
/// @throws Error  bad_input where `lod` asks for a level above 0 and there is none.
void check_levels(std::optional<float> lod, bool levels);

}  // namespace weft::cli
