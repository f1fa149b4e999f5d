// weft render: not here yet.

#include "cli/command.h"

namespace weft::cli {

void add_render(CLI::App& /*app*/, Session& /*session*/) {}

}  // namespace weft::cli
