// weft acquire: not here yet.

#include "cli/command.h"

namespace weft::cli {

void add_acquire(CLI::App& /*app*/, Session& /*session*/) {}

}  // namespace weft::cli
