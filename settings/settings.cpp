// The structure of settings: files, tables, places of keys, and the check that every key was asked
// for.
#include "settings/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "btf/atomic_file.h"
#include "settings/nearest_name.h"
#include "settings/node.h"

namespace weft {

namespace {

std::string place(const Document& document, const toml::source_region& source) {
  if (source.begin.line == 0) return document.name;
  return fmt::format("{}:{}:{}", document.name, source.begin.line, source.begin.column);
}

const toml::key* key_of(const toml::table& table, const std::string& name) {
  const auto found = table.find(name);
  return found == table.end() ? nullptr : &found->first;
}

nlohmann::json json_of(const toml::node& node, const std::string& where) {
  if (const auto* integer = node.as_integer()) return integer->get();
  if (const auto* flag = node.as_boolean()) return flag->get();
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_floating_point()) {
    const double value = number->get();
    if (!std::isfinite(value)) throw bad_input(where, "is not a finite number");
    // 1.0 and 1 are the same setting, and so the same text.
    const bool whole = value == std::floor(value) && std::abs(value) < 9.0e15;
    return whole ? nlohmann::json(static_cast<std::int64_t>(value)) : nlohmann::json(value);
  }
  if (const auto* array = node.as_array()) {
    nlohmann::json values = nlohmann::json::array();
    for (const toml::node& element : *array) values.push_back(json_of(element, where));
    return values;
  }
  if (const auto* table = node.as_table()) {
    nlohmann::json values = nlohmann::json::object();
    for (const auto& [key, value] : *table) values[std::string(key.str())] = json_of(value, where);
    return values;
  }
  throw bad_input(where, "is a date or a time, which no setting is");
}

}  // namespace

const toml::node* Settings::Node::find(const std::string& key) {
  asked.insert(key);
  return table == nullptr ? nullptr : table->get(key);
}

const toml::node& Settings::Node::require(const std::string& key) {
  const toml::node* found = find(key);
  if (found == nullptr)
    throw bad_input(where({}), fmt::format("the key '{}' is missing", full(key)));
  return *found;
}

std::string Settings::Node::where(const std::string& key) const {
  const std::string whole = key.empty() ? path : full(key);
  if (whole.empty()) return document->name;
  const std::string overridden = document->override_of(whole);
  if (!overridden.empty()) return "--set " + overridden;
  if (table != nullptr && !key.empty()) {
    if (const toml::key* found = key_of(*table, key);
        found != nullptr && found->source().begin.line) {
      return place(*document, found->source());
    }
  }
  if (table != nullptr && key.empty() && table->source().begin.line) {
    return place(*document, table->source());
  }
  const std::string inside = document->override_inside(whole);
  return inside.empty() ? document->name : "--set " + inside;
}

Error Settings::Node::wrong_type(const std::string& key, const char* expected,
                                 const toml::node& found) const {
  std::ostringstream type;
  type << found.type();
  return bad_input(where(key),
                   fmt::format("'{}' is {} ({}), expected {}", full(key),
                               json_of(found, where(key)).dump(), type.str(), expected));
}

std::shared_ptr<Settings::Node> Settings::Node::child(const std::string& name,
                                                      toml::table* child_table) {
  std::shared_ptr<Node>& node = children[name];
  if (!node) {
    node = std::make_shared<Node>();
    node->document = document;
    node->path = full(name);
    node->table = child_table;
  }
  return node;
}

bool Settings::Node::left_over(const std::string& key) const {
  return document->overrides.contains(full("type")) && !asked.contains(key) &&
         document->override_of(full(key)).empty() && document->override_inside(full(key)).empty();
}

void Settings::Node::finish() const {
  const toml::key* first = nullptr;
  if (table != nullptr) {
    for (const auto& [key, value] : *table) {
      const std::string name(key.str());
      if (asked.contains(name) || left_over(name)) continue;
      if (first == nullptr || key.source().begin.line < first->source().begin.line) first = &key;
    }
  }
  if (first != nullptr) {
    const std::string name(first->str());
    const std::vector<std::string> valid(asked.begin(), asked.end());
    const std::string nearest = nearest_name(name, valid);
    const std::string meant =
        nearest.empty() ? "" : fmt::format("; did you mean '{}'", full(nearest));
    throw bad_input(where(name), fmt::format("unknown key '{}'{}", full(name), meant),
                    valid.empty() ? "no key is valid here"
                                  : fmt::format("valid here: {}", fmt::join(valid, ", ")));
  }
  for (const auto& [name, node] : children) node->finish();
}

Settings::Settings() : Settings(from_text({}, "settings")) {}

Settings::Settings(std::shared_ptr<Node> node) : node_(std::move(node)) {}

Settings Settings::from_file(const std::filesystem::path& path,
                             const std::vector<std::string>& overrides) {
  auto node = std::make_shared<Node>();
  node->document = std::make_shared<Document>(
      parse_document(read_text(path), path.string(), path.parent_path(), overrides));
  node->table = &node->document->root;
  return Settings(std::move(node));
}

Settings Settings::from_text(const std::string& text, const std::string& name,
                             const std::vector<std::string>& overrides) {
  auto node = std::make_shared<Node>();
  node->document = std::make_shared<Document>(parse_document(text, name, {}, overrides));
  node->table = &node->document->root;
  return Settings(std::move(node));
}

bool Settings::has(const std::string& key) const {
  return node_->find(key) != nullptr;
}

Settings Settings::table(const std::string& key) const {
  const toml::node* found = node_->find(key);
  if (found != nullptr && !found->is_table()) throw node_->wrong_type(key, "a table", *found);
  return Settings(node_->child(key, found ? node_->table->get(key)->as_table() : nullptr));
}

Settings Settings::table(const std::string& key, const std::string& defaults) const {
  const bool complete = has(key) && table(key).has("type");
  if (!complete) {
    const toml::table values = toml::parse(defaults);
    if (node_->table == nullptr) node_->table = &node_->made.emplace();
    if (!has(key)) {
      node_->table->insert(key, toml::table{});
      node_->children.erase(key);
    }
    toml::table* own = table(key).node_->table;
    for (const auto& [name, value] : values) {
      value.visit([&](const auto& typed) { own->insert(name.str(), typed); });
    }
  }
  return table(key);
}

std::vector<Settings> Settings::tables(const std::string& key) const {
  if (!has(key)) return {};
  toml::array* array = node_->table->get(key)->as_array();
  if (array == nullptr) throw node_->wrong_type(key, "an array of tables", *node_->find(key));
  std::vector<Settings> elements;
  for (std::size_t i = 0; i < array->size(); ++i) {
    toml::table* element = array->get(i)->as_table();
    if (element == nullptr) throw node_->wrong_type(key, "an array of tables", *node_->find(key));
    elements.push_back(Settings(node_->child(fmt::format("{}.{}", key, i), element)));
  }
  return elements;
}

std::vector<std::string> Settings::keys() const {
  std::vector<std::string> names;
  if (node_->table == nullptr) return names;
  for (const auto& [key, value] : *node_->table) names.emplace_back(key.str());
  std::sort(names.begin(), names.end());
  return names;
}

std::string Settings::where(const std::string& key) const {
  return node_->where(key);
}

void Settings::finish() const {
  node_->finish();
}

std::string Settings::canonical_json() const {
  // The values that were read through sub-tables are written by those, which know which are paths.
  const auto write = [](const auto& self, const Node& node) -> nlohmann::json {
    nlohmann::json object = nlohmann::json::object();
    if (node.table == nullptr) return object;
    for (const auto& [key, value] : *node.table) {
      const std::string name(key.str());
      if (node.left_over(name)) continue;
      const auto child = node.children.find(name);
      if (child != node.children.end()) {
        object[name] = self(self, *child->second);
      } else if (node.children.contains(name + ".0")) {
        object[name] = nlohmann::json::array();
        for (std::size_t i = 0; i < value.as_array()->size(); ++i) {
          object[name].push_back(self(self, *node.children.at(fmt::format("{}.{}", name, i))));
        }
      } else if (const auto path = node.paths.find(name); path != node.paths.end()) {
        object[name] = path->second.filename().string();
        if (std::filesystem::is_regular_file(path->second)) {
          object[name + ".xxh3_128"] = file_checksum(path->second);
        }
      } else {
        object[name] = json_of(value, node.where(name));
      }
    }
    for (const auto& [name, child] : node.children) {
      if (child->made) object[name] = self(self, *child);
    }
    return object;
  };
  return write(write, *node_).dump();
}

}  // namespace weft
