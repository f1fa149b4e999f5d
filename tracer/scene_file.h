// Reads a scene file (TOML): camera, shapes, lights, materials.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tracer/scene.h"

namespace weft {

/// Opens an appearance by its path. `cli/` hands in the codecs', so that the tracer knows none.
using OpenAppearance =
    std::function<std::shared_ptr<const Appearance>(const std::filesystem::path&)>;

/// @param btf_paths  replacements for the `file` of `btf` materials: by material name, or for all
/// under "".
/// @param overrides  "KEY=VALUE" as in `--set`.
/// @throws Error     with file:line for what is wrong.
Scene read_scene(const std::filesystem::path& path, const OpenAppearance& open,
                 const std::map<std::string, std::filesystem::path>& btf_paths = {},
                 const std::vector<std::string>& overrides = {});

}  // namespace weft
