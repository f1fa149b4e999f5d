// Triangle meshes from OBJ and PLY files.
#pragma once

#include <filesystem>

#include "tracer/polygon_mesh.h"
#include "tracer/triangle_mesh.h"

namespace weft {

/// Reads positions, normals, texcoords and faces (polygons are cut into fans). `material_names` are
/// the OBJ's usemtl names, or its group/object names where a face has no usemtl; "default" for the
/// rest. Texcoords and normals are empty unless every face has them.
/// @throws Error  naming the file (and line where the format has lines): missing, no faces, an
/// index out of
///                range, a position that is not finite.
TriangleMesh read_mesh(const std::filesystem::path& path);

/// The same with its polygons left whole, for subdivision.
PolygonMesh read_polygons(const std::filesystem::path& path);

/// The names of `path`'s extension that `read_mesh` knows: "obj", "ply".
bool is_mesh_file(const std::filesystem::path& path);

/// Fills `tangents` (unit dP/du at each vertex, area-weighted over its triangles) from texcoords,
/// and `normals` where they are absent (area-weighted, smooth). Without texcoords any tangent
/// perpendicular to the normal.
void complete_frames(TriangleMesh& mesh);

}  // namespace weft
