// Files for the tests of mesostructures.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/temporary_folder.h"

inline std::filesystem::path mesostructure_folder() {
  return std::filesystem::path(WEFT_SOURCE_DIR) / "scenes" / "mesostructures";
}

/// Writes a file into a folder that is gone with the test; its path.
inline std::filesystem::path write_file(const TemporaryFolder& folder, const std::string& name,
                                        const std::string& content) {
  std::ofstream(folder.path / name, std::ios::binary) << content;
  return folder.path / name;
}
