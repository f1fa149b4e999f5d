// weft demo: not here yet.

#include "cli/command.h"

namespace weft::cli {

void add_demo(CLI::App& /*app*/, Session& /*session*/) {}

}  // namespace weft::cli
