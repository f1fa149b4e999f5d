// A small scene whose pictures are known, for tests of the renderers' commands.
#pragma once

#include <filesystem>
#include <fstream>

#include "tests/cli/small_dataset.h"

/// Writes scene.toml, a plane seen from above in light from above, and its BTF small.btf into
/// `folder`.
inline void write_small_scene(const std::filesystem::path& folder) {
  write_small_dataset(folder / "small.btf");
  std::ofstream(folder / "scene.toml") << R"(
camera = { eye = [0, 0, 4], up = [0, 1, 0], fov = 20, size = [8, 4] }
shape = [ { type = "plane", material = "cloth", size = [4, 4] } ]
light = [ { type = "directional", direction = [0, 0, 1], irradiance = 2 } ]
[material.cloth]
type = "btf"
file = "small.btf"
)";
}
