// Parsing `--lod`.

#include "cli/lod_option.h"

#include <algorithm>
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

bool has_levels(const Scene& scene) {
  return std::ranges::any_of(scene.materials, [](const SceneMaterial& material) {
    return material.appearance->has_lod();
  });
}

void check_levels(std::optional<float> lod, bool levels) {
  if (levels || !lod || *lod <= 0) return;
  throw bad_input("--lod", "asks for a level above 0, and no material of the scene has levels",
                  "a raw BTF has them; without them, write 0 or auto");
}

}  // namespace weft::cli
