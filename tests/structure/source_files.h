// Every file of the repository that a person wrote, as lines; what the rules of this folder are
// held against.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

struct SourceFile {
  std::string path;  ///< from the repository's root, with forward slashes
  std::uintmax_t bytes = 0;
  std::vector<std::string> lines;  ///< none where the file is not text (pictures)

  /// The folder at the root that it belongs to; tests/FOLDER/... counts as FOLDER.
  std::string folder() const;
  bool is_cpp() const;
};

/// All files below the root's own folders and beside them, sorted; no build products, no datasets.
const std::vector<SourceFile>& source_files();

/// What stands between the quotes or brackets of each `#include` of a file.
std::vector<std::string> includes_of(const SourceFile& file);
