// Files that appear whole or not at all, of several processes at once, and what killed ones leave.
#include "btf/atomic_file.h"

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <vector>

#include "tests/temporary_folder.h"

using namespace weft;
namespace fs = std::filesystem;

namespace {

/// The file aside that a process leaves which is killed while it writes `path`.
fs::path killed_while_writing(const fs::path& path) {
  const pid_t child = fork();
  if (child == 0) {
    write_atomically(path, [](const fs::path& temporary) {
      std::ofstream(temporary) << "half" << std::flush;
      raise(SIGKILL);
    });
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  REQUIRE(WIFSIGNALED(status));
  CHECK_FALSE(fs::exists(path));
  REQUIRE_FALSE(fs::is_empty(path.parent_path()));
  return fs::directory_iterator(path.parent_path())->path();
}

}  // namespace

TEST_CASE("what a killed process left is removed, what a living one writes is not") {
  const TemporaryFolder folder;
  const fs::path left = killed_while_writing(folder.path / "view_002.exr");
  CHECK(left.extension() == ".exr");
  write_atomically(folder.path / "view_003.exr", [&](const fs::path& mine) {
    std::ofstream(mine) << "whole";
    remove_abandoned(folder.path);
    CHECK(fs::exists(mine));
  });
  CHECK_FALSE(fs::exists(left));
  CHECK(read_text(folder.path / "view_003.exr") == "whole");
}

TEST_CASE("what another machine writes stays until nobody has touched it for an hour") {
  const TemporaryFolder folder;
  const fs::path left = killed_while_writing(folder.path / "view_002.exr");
  // Another machine's name in place of this one's.
  std::string name = left.filename().string();
  const std::size_t at = name.find(".part") + 5;
  REQUIRE(at + 9 < name.size());
  name.replace(at, 8, name.substr(at, 8) == "00000000" ? "11111111" : "00000000");
  const fs::path theirs = folder.path / name;
  fs::rename(left, theirs);
  remove_abandoned(folder.path);
  CHECK(fs::exists(theirs));
  fs::last_write_time(theirs, fs::file_time_type::clock::now() - std::chrono::hours(2));
  remove_abandoned(folder.path);
  CHECK_FALSE(fs::exists(theirs));
}

TEST_CASE("of many that create a file one succeeds, and its text is the one that stays") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "claim.json";
  constexpr int processes = 8;
  std::vector<pid_t> children;
  for (int i = 0; i < processes; ++i) {
    const pid_t child = fork();
    if (child == 0) _exit(create_text_atomically(path, std::to_string(i)) ? i + 1 : 0);
    children.push_back(child);
  }
  std::vector<int> winners;
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    if (WEXITSTATUS(status) > 0) winners.push_back(WEXITSTATUS(status) - 1);
  }
  REQUIRE(winners.size() == 1);
  CHECK(read_text(path) == std::to_string(winners[0]));
  CHECK(std::distance(fs::directory_iterator(folder.path), {}) == 1);
}
