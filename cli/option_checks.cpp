#include "cli/option_checks.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "settings/nearest_name.h"

namespace weft::cli {

namespace {

/// The whole text as a number, or nothing where it is not one.
template <typename T>
std::optional<T> parsed(const std::string& text) {
  T value{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// An empty answer lets the value pass, as CLI11 has it.
std::string expected(bool passes, const std::string& found, const std::string& what) {
  return passes ? "" : fmt::format("found '{}', expected {}", found, what);
}

}  // namespace

CLI::Validator at_least(double lower) {
  const auto check = [lower](const std::string& text) {
    const std::optional<double> value = parsed<double>(text);
    return expected(value && std::isfinite(*value) && *value >= lower, text,
                    fmt::format("a number of at least {}", lower));
  };
  return {check, ""};
}

CLI::Validator above(double lower) {
  const auto check = [lower](const std::string& text) {
    const std::optional<double> value = parsed<double>(text);
    return expected(value && std::isfinite(*value) && *value > lower, text,
                    fmt::format("a number above {}", lower));
  };
  return {check, ""};
}

CLI::Validator whole_number(std::uint64_t largest, std::uint64_t smallest) {
  const auto check = [largest, smallest](const std::string& text) {
    const std::optional<std::uint64_t> value = parsed<std::uint64_t>(text);
    return expected(value && *value >= smallest && *value <= largest, text,
                    fmt::format("a whole number from {} to {}", smallest, largest));
  };
  return {check, ""};
}

CLI::Validator one_of(const std::vector<std::string>& names) {
  const auto check = [names](const std::string& text) {
    if (std::ranges::find(names, text) != names.end()) return std::string();
    return fmt::format("there is no '{}': {}", text, name_hint(text, names));
  };
  return {check, "{" + CLI::detail::join(names, ",") + "}"};
}

}  // namespace weft::cli
