// `--lod`: a fixed level of detail, or each pixel's own.
#pragma once

#include <optional>
#include <string>

namespace weft::cli {

/// @param text  a number >= 0, or "auto" (answers nothing). @throws Error bad_input
std::optional<float> parse_lod(const std::string& text);

}  // namespace weft::cli
