// `--memory`: a size in bytes, or with a unit.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

namespace weft::cli {

/// Adds the option: 4096, 512MiB, 4GiB, ...; a sign, another unit or no number is refused. Units
/// are powers of 1,024.
void add_memory_option(CLI::App& command, std::uint64_t& bytes, const std::string& description);

}  // namespace weft::cli
