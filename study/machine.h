// What a measurement was taken on.
#pragma once

#include <string>

namespace weft {

struct Machine {
  std::string processor;  ///< model name; "unknown processor" where the system does not tell
  int cores = 1;          ///< hardware threads
  std::string system;     ///< e.g. "Debian GNU/Linux 12 (bookworm)"
};

Machine this_machine();

}  // namespace weft
