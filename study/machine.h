// What a measurement was taken on.
#pragma once

#include <string>

namespace weft {

struct Machine {
  std::string processor;  ///< name, family, model; "unknown processor" where no name is told
  int cores = 1;          ///< hardware threads
  std::string system;     ///< e.g. "Debian GNU/Linux 12 (bookworm)"
};

Machine this_machine();

}  // namespace weft
