// weft list: not here yet.

#include "cli/command.h"

namespace weft::cli {

void add_list(CLI::App& /*app*/, Session& /*session*/) {}

}  // namespace weft::cli
