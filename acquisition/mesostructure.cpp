#include "acquisition/mesostructure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/mesostructures/plane.h"
#include "btf/error.h"
#include "settings/nearest_name.h"

namespace weft {

namespace {

const MesostructureType& type_of(const Settings& settings) {
  const std::string name = settings.text("type");
  std::vector<std::string> names;
  for (const MesostructureType& type : mesostructure_types()) {
    if (type.name == name) return type;
    names.push_back(type.name);
  }
  throw bad_input(settings.where("type"), fmt::format("no mesostructure has the type '{}'", name),
                  name_hint(name, names));
}

/// Moves the content by (du, dv); whole tiles of it change nothing.
void shift(TileGeometry& tile, const Vec2& offset) {
  const Vec3 move(offset.x - std::floor(offset.x), offset.y - std::floor(offset.y), 0);
  for (Vec3& p : tile.mesh.positions) p += move;
  for (CurveSet::Control& control : tile.curves.controls) control.position += move;
}

void add_floor(TriangleMesh& mesh, const Settings& floor) {
  const auto height = static_cast<float>(floor.number("height", 0, -100, 100));
  const std::string name = floor.text("material", "floor");
  auto& names = mesh.material_names;
  const auto material =
      static_cast<std::uint16_t>(std::find(names.begin(), names.end(), name) - names.begin());
  if (material == names.size()) names.push_back(name);
  add_plane(mesh, height, material);
}

/// The default settings of a material of a type; null where it has none.
const std::string* default_of(const MesostructureType& type, const std::string& name) {
  for (const auto& [material, text] : type.default_materials) {
    if (material == name) return &text;
  }
  return nullptr;
}

std::vector<Bsdf> read_materials(const Settings& settings, const MesostructureType& type,
                                 const std::vector<std::string>& names) {
  const Settings table = settings.table("materials");
  for (const std::string& key : table.keys()) {
    if (key == "default" || std::find(names.begin(), names.end(), key) != names.end()) continue;
    throw bad_input(table.where(key), fmt::format("nothing is made of the material '{}'", key),
                    name_hint(key, names));
  }
  const bool has_default = table.has("default");
  std::vector<Bsdf> materials;
  std::vector<std::string> missing;
  for (const std::string& name : names) {
    if (const std::string* defaults = default_of(type, name)) {
      materials.push_back(read_bsdf(
          !table.has(name) && has_default ? table.table("default") : table.table(name, *defaults)));
    } else if (table.has(name)) {
      materials.push_back(read_bsdf(table.table(name)));
    } else if (has_default) {
      materials.push_back(read_bsdf(table.table("default")));
    } else {
      missing.push_back(name);
    }
  }
  if (!missing.empty()) {
    throw bad_input(
        settings.where(), fmt::format("no material is given for {}", fmt::join(missing, ", ")),
        fmt::format("add [materials.{}], or [materials.default] for all", missing.front()));
  }
  if (has_default)
    read_bsdf(table.table("default"));  // its keys are known even where nothing falls to it
  return materials;
}

/// Lowest and highest z of a tile.
std::pair<float, float> heights_of(const TileGeometry& tile) {
  const Bounds curves = bounds_of(tile.curves);
  float low = curves.low.z;
  float high = curves.high.z;
  for (const Vec3& p : tile.mesh.positions) {
    low = std::min(low, p.z);
    high = std::max(high, p.z);
  }
  return {low, high};
}

/// Rays start outside and meet the structure wherever the plane is; below all of it, the plane is a
/// mistake: what is seen slides by more than it is deep.
float read_reference_height(const Settings& settings, const TileGeometry& tile) {
  const auto [low, high] = heights_of(tile);
  const auto height = static_cast<float>(settings.number("reference_height", high, -100, 100));
  constexpr float rounding = 1e-4F;
  if (height < low - rounding) {
    throw bad_input(settings.where("reference_height"),
                    fmt::format("'reference_height' is {}, below the structure: its lowest point "
                                "is at {:.4g}, its highest at {:.4g}",
                                height, low, high),
                    "in tiles; leave it out for the highest point");
  }
  return height;
}

}  // namespace

Mesostructure read_mesostructure(const std::filesystem::path& path,
                                 const std::vector<std::string>& overrides) {
  const Settings settings = Settings::from_file(path, overrides);
  const MesostructureType& type = type_of(settings);
  Mesostructure result;
  result.type = type.name;
  TileGeometry tile = type.build(settings);
  if (!settings.flag("smooth", false)) tile.mesh.normals.clear();
  shift(tile, settings.vec2("offset", Vec2(0, 0)));
  if (settings.has("floor")) add_floor(tile.mesh, settings.table("floor"));
  result.materials = read_materials(settings, type, tile.mesh.material_names);
  result.tile_size = static_cast<float>(settings.number("tile_size", 1, 1e-6, 1e6));
  result.reference_height = read_reference_height(settings, tile);
  result.mesh = std::move(tile.mesh);
  result.curves = std::move(tile.curves);
  settings.finish();
  result.settings = settings.canonical_json();
  return result;
}

}  // namespace weft
