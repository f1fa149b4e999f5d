// What a bench holds its numbers to.
#pragma once

#include <string>

namespace weft {

/// One number and what it is held to.
struct Bar {
  std::string what;
  std::string unit;  ///< may be empty
  double value = 0;
  double limit = 0;
  bool at_least = false;  ///< else the value is to lie below the limit
  bool met() const { return at_least ? value >= limit : value < limit; }
};

}  // namespace weft
