// The scene that somebody forgot to light: its picture is black, which a warning explains.
#pragma once

#include "cli/command.h"
#include "tracer/scene.h"

namespace weft::cli {

/// Warns on stderr where the scene has no light; not with --quiet.
void warn_where_dark(const Scene& scene, const Session& session);

}  // namespace weft::cli
