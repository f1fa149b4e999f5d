// Walks the repository.
#include "tests/structure/source_files.h"

#include <algorithm>
#include <fstream>
#include <set>

namespace {

namespace fs = std::filesystem;

const std::set<std::string> folders = {".ci",    "acquisition", "btf",    "cli",      "cmake",
                                       "codecs", "docs",        "images", "settings", "gl_preview",
                                       "scenes", "study",       "tests",  "tracer"};
const std::set<std::string> pictures = {".exr", ".png", ".jpg", ".hdr"};

SourceFile read(const fs::path& path, const fs::path& root) {
  SourceFile file{fs::relative(path, root).generic_string(), fs::file_size(path), {}};
  if (pictures.contains(path.extension().string())) return file;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) file.lines.push_back(line);
  return file;
}

std::vector<SourceFile> walk() {
  const fs::path root = WEFT_SOURCE_DIR;
  std::vector<SourceFile> files;
  for (const auto& entry : fs::directory_iterator(root)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file() && (!name.starts_with('.') || name.starts_with(".clang"))) {
      files.push_back(read(entry.path(), root));
    }
    if (!entry.is_directory() || !folders.contains(name)) continue;
    for (const auto& inner : fs::recursive_directory_iterator(entry.path())) {
      if (inner.is_regular_file()) files.push_back(read(inner.path(), root));
    }
  }
  std::ranges::sort(files, {}, &SourceFile::path);
  return files;
}

}  // namespace

std::string SourceFile::folder() const {
  const std::string inner = path.starts_with("tests/") ? path.substr(6) : path;
  const auto slash = inner.find('/');
  return slash == std::string::npos ? "" : inner.substr(0, slash);
}

bool SourceFile::is_cpp() const {
  return path.ends_with(".h") || path.ends_with(".cpp");
}

const std::vector<SourceFile>& source_files() {
  static const std::vector<SourceFile> files = walk();
  return files;
}

std::vector<std::string> includes_of(const SourceFile& file) {
  std::vector<std::string> found;
  for (const std::string& line : file.lines) {
    if (!line.starts_with("#include")) continue;
    const auto begin = line.find_first_of("<\"");
    const auto end = line.find_first_of(">\"", begin + 1);
    if (end != std::string::npos) found.push_back(line.substr(begin + 1, end - begin - 1));
  }
  return found;
}
