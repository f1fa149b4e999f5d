// Plane, cube, sphere, torus, and meshes from files. Each reads its own keys (see
// shape_registry.cpp).
#pragma once

#include "settings/settings.h"
#include "tracer/triangle_mesh.h"

namespace weft {

TriangleMesh make_plane(const Settings& settings);
TriangleMesh make_cube(const Settings& settings);
TriangleMesh make_sphere(const Settings& settings);
TriangleMesh make_torus(const Settings& settings);
/// @throws Error  also where the file is missing or broken; see `read_mesh`.
TriangleMesh make_file_mesh(const Settings& settings);

}  // namespace weft
