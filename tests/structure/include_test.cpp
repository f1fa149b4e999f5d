// Which folder may include which: docs/architecture.md's table, held against every `#include` there
// is.

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "tests/structure/source_files.h"

namespace {

using Names = std::set<std::string>;

/// What a folder links to. What those link to is within its reach too.
const std::map<std::string, Names> links = {
    {"btf", {}},
    {"settings", {"btf"}},
    {"images", {"btf"}},
    {"codecs", {"btf", "images", "settings"}},
    {"tracer", {"btf", "images", "settings"}},
    {"acquisition", {"tracer"}},
    {"gl_preview", {"codecs", "tracer"}},
    {"study", {"codecs", "tracer", "acquisition", "gl_preview"}},
    {"cli", {"study", "gl_preview", "acquisition", "codecs", "tracer", "settings", "images"}},
};

/// Other people's headers that belong to some folders only, by the beginning of their path.
const std::map<std::string, Names> reserved = {
    {"OpenImageIO/", {"images"}},
    {"OpenEXR/", {"btf"}},
    {"Imf", {"btf"}},
    {"embree", {"tracer"}},
    {"opensubdiv/", {"tracer"}},
    {"assimp/", {"tracer"}},
    {"tiny_obj_loader", {"tracer"}},
    {"toml++/", {"settings"}},
    {"epoxy/", {"gl_preview"}},
    {"EGL/", {"gl_preview"}},
    {"GLFW/", {"gl_preview"}},
    {"imgui", {"gl_preview"}},
    {"backends/imgui", {"gl_preview"}},
    {"CLI/", {"cli"}},
};

void reach(const std::string& folder, Names& found) {
  if (!found.insert(folder).second) return;
  for (const std::string& next : links.at(folder)) reach(next, found);
}

std::string first_folder(const std::string& include) {
  const auto slash = include.find('/');
  return slash == std::string::npos ? "" : include.substr(0, slash);
}

}  // namespace

TEST_CASE("Every include keeps to the table of links") {
  std::size_t checked = 0;
  for (const SourceFile& file : source_files()) {
    if (!file.is_cpp() || !links.contains(file.folder())) continue;
    Names allowed;
    reach(file.folder(), allowed);
    for (const std::string& include : includes_of(file)) {
      INFO(file.path << " includes " << include);
      const std::string target = first_folder(include);
      if (links.contains(target)) CHECK(allowed.contains(target));
      ++checked;
    }
  }
  CHECK(checked > 100);
}

TEST_CASE("Libraries of others are named only where they belong") {
  for (const SourceFile& file : source_files()) {
    // tests/cli writes damaged files and so may use whatever writes them.
    if (!file.is_cpp() || !links.contains(file.folder()) || file.path.starts_with("tests/cli/")) {
      continue;
    }
    for (const std::string& include : includes_of(file)) {
      for (const auto& [prefix, folders] : reserved) {
        if (!include.starts_with(prefix)) continue;
        INFO(file.path << " includes " << include);
        CHECK(folders.contains(file.folder()));
      }
    }
  }
}

TEST_CASE("One file names Embree") {
  Names files;
  for (const SourceFile& file : source_files()) {
    if (!file.is_cpp()) continue;
    const auto includes = includes_of(file);
    if (std::ranges::any_of(includes, [](const auto& i) { return i.starts_with("embree"); })) {
      files.insert(file.path);
    }
  }
  CAPTURE(files);
  CHECK(files.size() == 1);
}

TEST_CASE("A unit test links its own folder and what that reaches") {
  // So the includes of tests/FOLDER are held against FOLDER's row; here, that every such folder has
  // a row.
  const Names without_row = {"structure", "consumer", "sanitizers", "slurm", "stability"};
  for (const SourceFile& file : source_files()) {
    if (!file.path.starts_with("tests/") || file.folder().empty()) continue;
    INFO(file.path);
    CHECK((links.contains(file.folder()) || without_row.contains(file.folder())));
  }
}
