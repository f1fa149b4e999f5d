// Wavefront OBJ files.
#pragma once

#include <filesystem>

#include "tracer/polygon_mesh.h"

namespace weft {

/// See `read_mesh`. The index of every corner has been checked.
/// @throws Error  naming file and line.
PolygonMesh read_obj(const std::filesystem::path& path);

}  // namespace weft
