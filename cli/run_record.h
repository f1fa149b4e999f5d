// How a run went, kept beside what it made: command, host, threads, times. Never part of the data.
#pragma once

#include <filesystem>

#include "cli/command.h"

namespace weft::cli {

/// Appends this run, and what it measured, to the JSON array in `path`, which it begins where there
/// is none.
void append_run(const std::filesystem::path& path, const Session& session);

}  // namespace weft::cli
