// weft compress: not here yet.

#include "cli/command.h"

namespace weft::cli {

void add_compress(CLI::App& /*app*/, Session& /*session*/) {}

}  // namespace weft::cli
