// `--btf PATH` and `--btf MATERIAL=PATH`: which dataset stands in for which material of a scene.
#pragma once

#include <filesystem>
#include <string>

#include "tracer/scene_file.h"

namespace weft::cli {

struct BtfOption {
  std::string material;  ///< empty: every BTF material
  std::filesystem::path path;
};

/// @param text  PATH, or MATERIAL=PATH; a folder that is there is a PATH even with '=' in its name.
/// @throws Error  bad_input where one side of '=' is empty.
BtfOption parse_btf_option(const std::string& text);

/// Opens datasets of any codec; each folder once, however often it is asked for.
OpenAppearance open_datasets();

}  // namespace weft::cli
