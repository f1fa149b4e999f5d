// weft info: not here yet.

#include "cli/command.h"

namespace weft::cli {

void add_info(CLI::App& /*app*/, Session& /*session*/) {}

}  // namespace weft::cli
