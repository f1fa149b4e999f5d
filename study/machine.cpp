#include "study/machine.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <thread>

namespace weft {

namespace {

/// What follows `separator` on the first line of a file that starts with `key`.
std::optional<std::string> value_in(const char* file, const std::string& key, char separator) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const std::size_t cut = line.find(separator);
    if (!line.starts_with(key) || cut == std::string::npos) continue;
    const std::size_t begin = line.find_first_not_of(" \"", cut + 1);
    const std::size_t end = line.find_last_not_of(" \"");
    if (begin != std::string::npos && end >= begin) return line.substr(begin, end - begin + 1);
  }
  return std::nullopt;
}

}  // namespace

Machine this_machine() {
  constexpr const char* cpus = "/proc/cpuinfo";
  std::string processor = value_in(cpus, "model name", ':').value_or("unknown processor");
  // Virtual machines tell no more by name than the brand.
  const auto family = value_in(cpus, "cpu family", ':');
  const auto model = value_in(cpus, "model\t", ':');
  if (family && model) processor += ", family " + *family + " model " + *model;
  return {processor, static_cast<int>(std::max(1U, std::thread::hardware_concurrency())),
          value_in("/etc/os-release", "PRETTY_NAME", '=').value_or("unknown system")};
}

}  // namespace weft
