#include "settings/document.h"

#include <fmt/format.h>

#include "btf/error.h"

namespace weft {

namespace {

toml::table parse_toml(const std::string& text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    throw bad_input(fmt::format("{}:{}:{}", name, at.line, at.column),
                    std::string(error.description()));
  }
}

std::vector<std::string> split_path(const std::string& path, const std::string& where) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.') {
      parts.emplace_back();
    } else if (c != ' ') {
      parts.back() += c;
    }
  }
  for (const std::string& part : parts) {
    if (part.empty()) throw bad_input(where, "a part of the key is empty");
  }
  return parts;
}

/// A TOML document that holds the value under the key "value". What no TOML value looks like is a
/// string.
toml::table parse_value(const std::string& value, const std::string& where) {
  if (value.empty()) throw bad_input(where, "the value is empty", "KEY=VALUE is expected");
  try {
    return toml::parse("value = " + value);
  } catch (const toml::parse_error& error) {
    const bool bare_word = std::string("[]{}\"'").find(value.front()) == std::string::npos;
    if (!bare_word) throw bad_input(where, std::string(error.description()));
    return toml::table{{"value", value}};
  }
}

/// The table or array element named `part` inside `parent`; a table is made where a key is absent.
toml::node& descend(toml::node& parent, const std::string& part, const std::string& where) {
  if (toml::array* array = parent.as_array()) {
    const bool digits = part.find_first_not_of("0123456789") == std::string::npos;
    const std::size_t index = digits && part.size() < 7 ? std::stoul(part) : array->size();
    if (index >= array->size()) {
      throw bad_input(where,
                      fmt::format("'{}' is no element of an array of {}", part, array->size()),
                      "elements count from 0");
    }
    return *array->get(index);
  }
  toml::table* table = parent.as_table();
  if (table == nullptr) throw bad_input(where, fmt::format("there is no table around '{}'", part));
  if (toml::node* child = table->get(part)) return *child;
  return table->insert(part, toml::table{}).first->second;
}

void apply_override(Document& document, const std::string& pair) {
  const std::string where = "--set " + pair;
  const std::size_t equals = pair.find('=');
  if (equals == std::string::npos)
    throw bad_input(where, "'=' is missing", "KEY=VALUE is expected");
  const std::vector<std::string> parts = split_path(pair.substr(0, equals), where);
  const toml::table holder = parse_value(pair.substr(equals + 1), where);
  const toml::node& value = *holder.get("value");

  toml::node* parent = &document.root;
  std::string path;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    parent = &descend(*parent, parts[i], where);
    path += parts[i] + ".";
  }
  value.visit([&](const auto& typed) {
    if (toml::array* array = parent->as_array()) {
      descend(*parent, parts.back(), where);  // refuses an index out of range
      array->replace(array->cbegin() + std::stol(parts.back()), typed);
    } else if (toml::table* table = parent->as_table()) {
      table->insert_or_assign(parts.back(), typed);
    } else {
      throw bad_input(where, fmt::format("there is no table around '{}'", parts.back()));
    }
  });
  document.overrides[path + parts.back()] = pair;
}

}  // namespace

std::string Document::override_of(const std::string& path) const {
  for (std::string outer = path;;) {
    const auto found = overrides.find(outer);
    if (found != overrides.end()) return found->second;
    const std::size_t dot = outer.rfind('.');
    if (dot == std::string::npos) return {};
    outer.resize(dot);
  }
}

std::string Document::override_inside(const std::string& path) const {
  const auto found = overrides.lower_bound(path + ".");
  return found != overrides.end() && found->first.starts_with(path + ".") ? found->second
                                                                          : std::string();
}

Document parse_document(const std::string& text, const std::string& name,
                        const std::filesystem::path& folder,
                        const std::vector<std::string>& overrides) {
  Document document;
  document.name = name;
  document.folder = folder;
  document.root = parse_toml(text, name);
  for (const std::string& pair : overrides) apply_override(document, pair);
  return document;
}

}  // namespace weft
