#include "study/peak_memory.h"

#include <malloc.h>

#include <fstream>
#include <string>

namespace weft {

namespace {

// "VmHWM" is the largest resident set since it was last forgotten.
std::optional<std::size_t> largest_resident_set() {
  std::ifstream status("/proc/self/status");
  constexpr std::size_t kibibyte = 1024;
  for (std::string word; status >> word;) {
    std::size_t value = 0;
    if (word == "VmHWM:" && status >> value) return value * kibibyte;
  }
  return std::nullopt;
}

bool forget_largest_resident_set() {
  std::ofstream file("/proc/self/clear_refs");
  file << 5 << std::flush;
  return file.good();
}

}  // namespace

PeakMemory::PeakMemory() {
  malloc_trim(0);
  if (forget_largest_resident_set()) before_ = largest_resident_set();
}

std::optional<std::size_t> PeakMemory::growth() const {
  const std::optional<std::size_t> now = largest_resident_set();
  if (!before_ || !now) return std::nullopt;
  return *now > *before_ ? *now - *before_ : 0;
}

}  // namespace weft
