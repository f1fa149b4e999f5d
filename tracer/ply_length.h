// How long a PLY file has to be: what its header promises.
#pragma once

#include <filesystem>

namespace weft {

/// assimp reads on where a truncated file ends, so its length is checked before.
/// @throws Error  naming the file, the element and where its data end, where the header cannot be
/// understood or the
///                file is shorter than it says.
void require_whole_ply(const std::filesystem::path& path);

}  // namespace weft
