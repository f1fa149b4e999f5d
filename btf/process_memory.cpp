#include "btf/process_memory.h"

#include <unistd.h>

#include <fstream>

namespace weft {

namespace {

struct Pages {
  std::size_t resident = 0;
  std::size_t shared = 0;  // with a file
};

Pages pages() {
  std::ifstream statm("/proc/self/statm");
  std::size_t all = 0;
  Pages result;
  statm >> all >> result.resident >> result.shared;
  return result;
}

std::size_t bytes(std::size_t pages) {
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

std::size_t resident_bytes() {
  return bytes(pages().resident);
}

std::size_t anonymous_bytes() {
  const Pages now = pages();
  return bytes(now.resident - now.shared);
}

}  // namespace weft
