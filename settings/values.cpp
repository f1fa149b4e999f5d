// The typed answers of settings: each checks type and range, and names the line where it is not as
// asked.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "settings/nearest_name.h"
#include "settings/node.h"

namespace weft {

namespace {

/// The number of a node; nothing where it is not a number.
std::optional<double> number_of(const toml::node& node) {
  if (const auto* integer = node.as_integer()) return static_cast<double>(integer->get());
  if (const auto* number = node.as_floating_point()) return number->get();
  return std::nullopt;
}

void require_float_range(const std::vector<double>& values, const std::string& where,
                         const std::string& key) {
  for (const double value : values) {
    if (std::abs(value) > std::numeric_limits<float>::max()) {
      throw bad_input(where, fmt::format("'{}' holds {}, which is too large", key, value));
    }
  }
}

}  // namespace

double Settings::number(const std::string& key) const {
  const toml::node& node = node_->require(key);
  if (const auto* number = node.as_floating_point(); number && !std::isfinite(number->get())) {
    throw bad_input(where(key), fmt::format("'{}' is {}, expected a finite number",
                                            node_->full(key), number->get()));
  }
  const std::optional<double> value = number_of(node);
  if (!value) throw node_->wrong_type(key, "a number", node);
  return *value;
}

double Settings::number(const std::string& key, double fallback) const {
  return has(key) ? number(key) : fallback;
}

double Settings::number(const std::string& key, double fallback, double lower, double upper) const {
  const double value = number(key, fallback);
  if (value < lower || value > upper) {
    throw bad_input(where(key), fmt::format("'{}' is {}, expected {} to {}", node_->full(key),
                                            value, lower, upper));
  }
  return value;
}

std::int64_t Settings::integer(const std::string& key, std::int64_t fallback, std::int64_t lower,
                               std::int64_t upper) const {
  if (!has(key)) return fallback;
  const toml::node& node = node_->require(key);
  const double value = number(key);
  if (value != std::floor(value)) throw node_->wrong_type(key, "an integer", node);
  if (value < static_cast<double>(lower) || value > static_cast<double>(upper)) {
    throw bad_input(where(key), fmt::format("'{}' is {}, expected {} to {}", node_->full(key),
                                            value, lower, upper));
  }
  // An integer of the file keeps all its digits; one written as 1e3 has those of a double.
  return node.is_integer() ? node.as_integer()->get() : static_cast<std::int64_t>(value);
}

bool Settings::flag(const std::string& key, bool fallback) const {
  const toml::node* node = node_->find(key);
  if (node == nullptr) return fallback;
  if (!node->is_boolean()) throw node_->wrong_type(key, "true or false", *node);
  return node->as_boolean()->get();
}

std::string Settings::text(const std::string& key) const {
  const toml::node& node = node_->require(key);
  if (!node.is_string()) throw node_->wrong_type(key, "a string", node);
  return node.as_string()->get();
}

std::string Settings::text(const std::string& key, const std::string& fallback) const {
  return has(key) ? text(key) : fallback;
}

std::string Settings::choice(const std::string& key,
                             const std::vector<std::string>& choices) const {
  if (!has(key)) return choices.front();
  const toml::node& node = node_->require(key);
  // A choice may be spelt as a number: `bits = 8`.
  const auto number = node.value_exact<std::int64_t>();
  const std::string value = number ? std::to_string(*number) : text(key);
  if (std::find(choices.begin(), choices.end(), value) == choices.end()) {
    throw bad_input(where(key),
                    fmt::format("'{}' is '{}', expected one of {}", node_->full(key), value,
                                fmt::join(choices, ", ")),
                    name_hint(value, choices));
  }
  return value;
}

std::vector<double> Settings::numbers(const std::string& key) const {
  const toml::node& node = node_->require(key);
  const toml::array* array = node.as_array();
  if (array == nullptr) throw node_->wrong_type(key, "an array of numbers", node);
  std::vector<double> values;
  for (const toml::node& element : *array) {
    const std::optional<double> value = number_of(element);
    if (!value) throw node_->wrong_type(key, "an array of numbers", node);
    if (!std::isfinite(*value)) {
      throw bad_input(where(key), fmt::format("'{}' holds {}, expected finite numbers",
                                              node_->full(key), *value));
    }
    values.push_back(*value);
  }
  return values;
}

Vec2 Settings::vec2(const std::string& key, const Vec2& fallback) const {
  if (!has(key)) return fallback;
  const std::vector<double> values = numbers(key);
  if (values.size() != 2) throw node_->wrong_type(key, "two numbers", *node_->find(key));
  require_float_range(values, where(key), node_->full(key));
  return {static_cast<float>(values[0]), static_cast<float>(values[1])};
}

Vec3 Settings::vec3(const std::string& key) const {
  const std::vector<double> values = numbers(key);
  if (values.size() != 3) throw node_->wrong_type(key, "three numbers", *node_->find(key));
  require_float_range(values, where(key), node_->full(key));
  return {static_cast<float>(values[0]), static_cast<float>(values[1]),
          static_cast<float>(values[2])};
}

Vec3 Settings::vec3(const std::string& key, const Vec3& fallback) const {
  return has(key) ? vec3(key) : fallback;
}

Rgb Settings::rgb(const std::string& key, const Rgb& fallback) const {
  if (!has(key)) return fallback;
  const bool one = number_of(*node_->find(key)).has_value();
  const Vec3 values = one ? Vec3(static_cast<float>(number(key))) : vec3(key);
  if (std::min({values.x, values.y, values.z}) < 0) {
    throw bad_input(where(key), fmt::format("'{}' has a negative channel", node_->full(key)));
  }
  require_float_range({values.x, values.y, values.z}, where(key), node_->full(key));
  return {values.x, values.y, values.z};
}

std::filesystem::path Settings::path(const std::string& key) const {
  const std::filesystem::path value = text(key);
  if (value.empty()) throw bad_input(where(key), fmt::format("'{}' is empty", node_->full(key)));
  const bool from_command_line = !node_->document->override_of(node_->full(key)).empty();
  return node_->paths[key] = from_command_line ? value : node_->document->folder / value;
}

std::filesystem::path Settings::existing_path(const std::string& key) const {
  std::filesystem::path value = path(key);
  if (!std::filesystem::exists(value)) {
    throw bad_input(where(key),
                    fmt::format("'{}' is {}: no such file", node_->full(key), value.string()));
  }
  return value;
}

}  // namespace weft
