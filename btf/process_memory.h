// What this process holds in memory.
#pragma once

#include <cstddef>

namespace weft {

/// Bytes in memory now, from Linux' /proc; 0 where that cannot be read.
std::size_t resident_bytes();
/// Those of them that no file backs: the kernel cannot drop them.
std::size_t anonymous_bytes();

}  // namespace weft
