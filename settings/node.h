// One table of a settings document and what was asked of it: the inside of `Settings`.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "btf/error.h"
#include "settings/document.h"
#include "settings/settings.h"

namespace weft {

struct Settings::Node {
  std::shared_ptr<Document> document;
  std::string path;              ///< dotted path of this table; empty for the root
  toml::table* table = nullptr;  ///< inside `document`; null where the table is absent
  std::optional<toml::table>
      made;                     ///< the table where the file has none and defaults were filled in
  std::set<std::string> asked;  ///< keys that somebody knows
  std::map<std::string, std::filesystem::path> paths;     ///< answers of `path`, by key
  std::map<std::string, std::shared_ptr<Node>> children;  ///< by key, or "key.index"

  std::string full(const std::string& key) const { return path.empty() ? key : path + "." + key; }
  /// The value of a key, which is marked as asked for; null where it is absent.
  const toml::node* find(const std::string& key);
  /// @throws Error  where it is absent.
  const toml::node& require(const std::string& key);
  std::string where(const std::string& key) const;
  Error wrong_type(const std::string& key, const char* expected, const toml::node& found) const;
  std::shared_ptr<Node> child(const std::string& name, toml::table* child_table);
  void finish() const;
  /// The file's own keys of a table whose `type` was overridden belong to the type that it had.
  bool left_over(const std::string& key) const;
};

}  // namespace weft
