// PLY files, ASCII and binary.
#pragma once

#include <filesystem>

#include "tracer/polygon_mesh.h"

namespace weft {

/// See `read_mesh`. All faces have the material "default".
/// @throws Error  naming the file.
PolygonMesh read_ply(const std::filesystem::path& path);

}  // namespace weft
