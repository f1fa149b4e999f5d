// A modelled mesostructure: one periodic tile of triangles and fibres with materials, and where its
// BTF plane lies.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "settings/settings.h"
#include "tracer/bsdf.h"
#include "tracer/curves.h"
#include "tracer/triangle_mesh.h"

namespace weft {

/// Everything is in tile units: x, y in [0, 1] cover the tile, which repeats without end; z is up
/// in the same unit. The geometry may stick out of [0, 1]^2 sideways; what does wraps into the
/// neighbours.
struct Mesostructure {
  std::string type;
  TriangleMesh mesh;            ///< `normals` present: smooth shading
  CurveSet curves;              ///< its materials are the mesh's too
  std::vector<Bsdf> materials;  ///< in the order of mesh.material_names
  float tile_size = 1;          ///< world units a tile
  float reference_height = 0;   ///< of the BTF plane, in tile units
  std::string settings;         ///< canonical JSON: part of a dataset's provenance
};

/// What a type builds: triangles, fibres or both.
struct TileGeometry {
  TileGeometry(TriangleMesh triangles, CurveSet fibres = {})
      : mesh(std::move(triangles)), curves(std::move(fibres)) {}
  TriangleMesh mesh;
  CurveSet curves;
};

/// One row of the table of types.
struct MesostructureType {
  std::string name;
  std::string summary;     ///< one line
  std::string parameters;  ///< lines "name = default   meaning"
  /// Builds the tile in tile units from the file's keys. Materials are named, not read here.
  /// Offsets, floor, tile size and reference height are the caller's work.
  std::function<TileGeometry(const Settings&)> build;
  /// Material names that the tile may use, with their default settings in TOML; empty where the
  /// file must say.
  std::vector<std::pair<std::string, std::string>> default_materials;
};

/// Every type; the table is in mesostructure_registry.cpp, a line a type.
std::span<const MesostructureType> mesostructure_types();

/// Reads a mesostructure file. @param overrides  "KEY=VALUE" as in `--set`.
/// @throws Error  with file:line for what is wrong (unknown key or type, a mesh without faces, a
/// height that is NaN).
Mesostructure read_mesostructure(const std::filesystem::path& path,
                                 const std::vector<std::string>& overrides = {});

}  // namespace weft
