// Files for the tests of mesostructures.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace weft {

inline std::filesystem::path mesostructure_folder() {
  return std::filesystem::path(WEFT_SOURCE_DIR) / "scenes" / "mesostructures";
}

/// A folder that is gone with its owner.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("weft_mesostructure_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace weft
