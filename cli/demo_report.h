// The demo's page: what was measured, laid out as pictures and a table.
#pragma once

#include <span>
#include <string>

#include "cli/demo_job.h"
#include "study/report.h"

namespace weft::cli {

/// @param footer  machine, command and duration.
Report demo_report(std::span<const DemoResult> results, const DemoSettings& settings,
                   const std::string& footer);

}  // namespace weft::cli
