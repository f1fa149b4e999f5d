// What the folder of every fitted codec tells beside its arrays: texels, directions, parameters,
// provenance, checksums.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "btf/btf.h"
#include "btf/hemisphere_sampling.h"

namespace weft {

struct FittedHead {
  int width = 0;
  int height = 0;
  HemisphereSampling views;
  HemisphereSampling lights;
  std::string parameters = "{}";  ///< JSON: every parameter of the fit, defaults too
  std::string provenance = "{}";  ///< JSON: the data's

  std::size_t texels() const { return static_cast<std::size_t>(width) * height; }
  std::size_t pairs() const { return views.size() * lights.size(); }
};

/// What a fit to `btf` knows before it begins.
FittedHead fitted_head(const Btf& btf, std::string parameters);

/// Texture buffers of the directions' tables, in bytes.
std::size_t direction_table_bytes(const FittedHead& head);

/// Writes the folder, whole or not at all. `write` writes the arrays' files and answers what
/// `codec.json` says of them and of the model.
/// @throws Error
void write_fitted(const std::filesystem::path& folder, const std::string& codec, int version,
                  const FittedHead& head,
                  const std::function<nlohmann::ordered_json(const std::filesystem::path&)>& write);

/// Reads a folder that `write_fitted` wrote: checksums, then the head, then what `read` makes of
/// the rest.
/// @throws Error  naming the folder's file or field that is missing, damaged or of another version.
void read_fitted(const std::filesystem::path& folder, const std::string& codec, int version,
                 const std::function<void(const nlohmann::ordered_json&, FittedHead)>& read);

}  // namespace weft
