// Checks of option values, told in a short sentence: what was found, and what was expected.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace weft::cli {

/// A finite number, lower <= value.
CLI::Validator at_least(double lower);
/// A finite number, lower < value.
CLI::Validator above(double lower);
/// A whole number in smallest..largest.
CLI::Validator whole_number(std::uint64_t largest, std::uint64_t smallest = 0);
/// One of `names`; what is not is answered with the nearest, and all of them.
CLI::Validator one_of(const std::vector<std::string>& names);

}  // namespace weft::cli
