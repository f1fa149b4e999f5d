// weft validate: not here yet.

#include "cli/command.h"

namespace weft::cli {

void add_validate(CLI::App& /*app*/, Session& /*session*/) {}

}  // namespace weft::cli
