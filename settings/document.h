// A parsed TOML document with its overrides laid in: only the settings library sees toml++ through
// this.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <toml++/toml.h>

namespace weft {

struct Document {
  std::string name;              ///< as errors call it: the file's path
  std::filesystem::path folder;  ///< relative paths in the file start here
  toml::table root;
  std::map<std::string, std::string> overrides;  ///< dotted path to the "KEY=VALUE" that set it

  /// The "KEY=VALUE" that set `path` or a table around it; empty where the file did.
  std::string override_of(const std::string& path) const;
  /// The first "KEY=VALUE" that set something inside `path`; empty where there is none.
  std::string override_inside(const std::string& path) const;
};

/// @throws Error  with name:line:column for a syntax error; `--set KEY=VALUE` where an override is
/// at fault.
Document parse_document(const std::string& text, const std::string& name,
                        const std::filesystem::path& folder,
                        const std::vector<std::string>& overrides);

}  // namespace weft
