// Where the scenes that come with Weft are: mesostructures, render scenes, studies.
#pragma once

#include <filesystem>

namespace weft::cli {

/// @param chosen  what the user named; empty: $WEFT_SCENES, else ../share/weft/scenes beside the
/// program's folder
///                (where it is installed), else ./scenes.
/// @throws Error  bad_input, naming what was looked for, where the folder is not there.
std::filesystem::path scene_folder(const std::filesystem::path& chosen = {});

}  // namespace weft::cli
