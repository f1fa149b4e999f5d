// weft extract: not here yet.

#include "cli/command.h"

namespace weft::cli {

void add_extract(CLI::App& /*app*/, Session& /*session*/) {}

}  // namespace weft::cli
