// weft compare: not here yet.

#include "cli/command.h"

namespace weft::cli {

void add_compare(CLI::App& /*app*/, Session& /*session*/) {}

}  // namespace weft::cli
