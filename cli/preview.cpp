// weft preview: not here yet.

#include "cli/command.h"

namespace weft::cli {

void add_preview(CLI::App& /*app*/, Session& /*session*/) {}

}  // namespace weft::cli
