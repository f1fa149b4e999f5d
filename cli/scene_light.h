// What a scene's light has that its author may not know of: none at all, or values below zero.
#pragma once

#include "cli/command.h"
#include "tracer/scene.h"

namespace weft::cli {

/// Warns on stderr, not with --quiet; counts `environment_negative_values` for --json.
void report_light(const Scene& scene, Session& session);

}  // namespace weft::cli
