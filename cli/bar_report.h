// How benches tell their bars.
#pragma once

#include <span>

#include "cli/command.h"
#include "study/bar.h"

namespace weft::cli {

/// A line a bar, and `bars` in what --json prints.
void report_bars(std::span<const Bar> bars, Session& session);

}  // namespace weft::cli
