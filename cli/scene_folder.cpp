#include "cli/scene_folder.h"

#include <cstdlib>
#include <string>
#include <system_error>

#include "btf/error.h"

namespace weft::cli {

namespace fs = std::filesystem;

fs::path scene_folder(const fs::path& chosen) {
  if (!chosen.empty()) {
    if (!fs::is_directory(chosen)) throw bad_input(chosen.string(), "is no folder of scenes");
    return chosen;
  }
  const char* variable = std::getenv("WEFT_SCENES");
  if (variable != nullptr && *variable != '\0') {
    if (!fs::is_directory(variable)) {
      throw bad_input("WEFT_SCENES", std::string("'") + variable + "' is no folder");
    }
    return variable;
  }
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  const fs::path installed = program.parent_path() / ".." / "share" / "weft" / "scenes";
  if (!unknown && fs::is_directory(installed)) return installed.lexically_normal();
  if (fs::is_directory("scenes")) return "scenes";
  throw bad_input(
      "scenes", "no folder of scenes in " + installed.lexically_normal().string() + " or ./scenes",
      "name it with --scenes or in WEFT_SCENES");
}

}  // namespace weft::cli
