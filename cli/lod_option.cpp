// Parsing `--lod`.

#include "cli/lod_option.h"

#include <charconv>
#include <cmath>

#include "btf/error.h"

namespace weft::cli {

std::optional<float> parse_lod(const std::string& text) {
  if (text == "auto") return std::nullopt;
  float lod = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), lod);
  if (problem != std::errc() || end != text.data() + text.size() || !(lod >= 0) ||
      !std::isfinite(lod)) {
    throw bad_input("--lod", "found '" + text + "', expected 'auto' or a level of at least 0");
  }
  return lod;
}

}  // namespace weft::cli
