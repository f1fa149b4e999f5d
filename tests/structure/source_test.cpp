// Rules that hold for every file of the repository: it says what it is, it is small, it names no
// machine.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cctype>
#include <string_view>

#include "tests/structure/source_files.h"

namespace {

/// The first two characters of a comment in such a file; empty where the format has none.
std::string_view comment_of(const SourceFile& file) {
  if (file.is_cpp()) return "//";
  for (const std::string_view ending : {".cmake", ".toml", "CMakeLists.txt", "packages.txt"}) {
    if (file.path.ends_with(ending)) return "# ";
  }
  return "";
}

bool has_own_header(const SourceFile& file) {
  if (!file.path.ends_with(".cpp")) return false;
  const std::string header = file.path.substr(0, file.path.size() - 3) + "h";
  return std::ranges::find(source_files(), header, &SourceFile::path) != source_files().end();
}

}  // namespace

TEST_CASE("Every source opens with a comment that says its job") {
  for (const SourceFile& file : source_files()) {
    const std::string_view comment = comment_of(file);
    if (has_own_header(file)) continue;  // which says it for both
    if (comment.empty()) continue;
    INFO(file.path);
    REQUIRE(!file.lines.empty());
    // A folder's CMakeLists.txt of one declaration says it by that.
    if (file.path.ends_with("CMakeLists.txt") && file.lines.size() <= 3) continue;
    if (file.path == "CMakeLists.txt") continue;
    CHECK(file.lines.front().starts_with(comment));
  }
}

TEST_CASE("Every header is guarded") {
  for (const SourceFile& file : source_files()) {
    if (!file.path.ends_with(".h")) continue;
    INFO(file.path);
    CHECK(std::ranges::find(file.lines, "#pragma once") != file.lines.end());
  }
}

TEST_CASE("No file is larger than 1 MiB") {
  for (const SourceFile& file : source_files()) {
    INFO(file.path);
    CHECK(file.bytes <= 1024 * 1024);
  }
}

TEST_CASE("No file names a folder of one machine, or leaves work for later") {
  // In pieces, so that this file does not find itself.
  const std::string banned[] = {
      "/wo"
      "rk/",
      "/ho"
      "me/",
      "/ro"
      "ot/",
      "TO"
      "DO",
      "FIX"
      "ME",
      "XX"
      "X:"};
  for (const SourceFile& file : source_files()) {
    if (file.path == "LICENSE") continue;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      for (const std::string& word : banned) {
        INFO(file.path << ":" << i + 1 << ": " << word);
        CHECK(file.lines[i].find(word) == std::string::npos);
      }
    }
  }
}

TEST_CASE("Files are named after what they hold") {
  for (const SourceFile& file : source_files()) {
    if (!file.is_cpp()) continue;
    const auto name = file.path.substr(file.path.rfind('/') + 1);
    INFO(file.path);
    for (const char* empty_word : {"util", "common", "helper", "manager", "misc"}) {
      CHECK(name.find(empty_word) == std::string::npos);
    }
    for (const char c : name) CHECK((std::islower(c) || std::isdigit(c) || c == '_' || c == '.'));
  }
}
