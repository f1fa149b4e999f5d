// What an interrupted fit keeps: its own pieces come back, those of another fit and damaged ones do
// not.

#include "codecs/fit_checkpoint.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "btf/error.h"
#include "tests/codecs/synthetic_btf.h"
#include "tests/temporary_folder.h"

using namespace weft;
namespace fs = std::filesystem;

namespace {

const std::vector<double> piece{1.5, -2.25, 1e-300};

void damage(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".f64") continue;
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(-3, std::ios::end);
    file.put('\x55');
  }
}

}  // namespace

TEST_CASE("A checkpoint gives its pieces back, to the last bit") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "a.partial";
  const FitCheckpoint first(path, "key");
  CHECK(!fs::exists(path));
  CHECK(!first.find("view_0", 3).has_value());
  first.keep("view_0", piece);
  const FitCheckpoint second(path, "key");
  CHECK(second.find("view_0", 3) == piece);
  CHECK(!second.find("view_0", 4).has_value());
  CHECK(!second.find("view_1", 3).has_value());
  remove_checkpoint(path);
  CHECK(!fs::exists(path));
}

TEST_CASE("Pieces of another fit and damaged ones are not taken") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "a.partial";
  FitCheckpoint(path, "key").keep("view_0", piece);
  CHECK(!FitCheckpoint(path, "other key").find("view_0", 3).has_value());
  CHECK(!fs::exists(path));
  const FitCheckpoint again(path, "key");
  again.keep("view_0", piece);
  damage(path);
  CHECK(!again.find("view_0", 3).has_value());
}

TEST_CASE("A checkpoint without a folder keeps nothing, and none takes the place of other files") {
  const FitCheckpoint nothing;
  nothing.keep("view_0", piece);
  CHECK(!nothing.find("view_0", 3).has_value());
  const TemporaryFolder folder;
  std::ofstream(folder.path / "letter.txt") << "dear";
  CHECK_THROWS_AS(FitCheckpoint(folder.path, "key"), Error);
  remove_checkpoint(folder.path);
  CHECK(fs::exists(folder.path / "letter.txt"));
}

TEST_CASE("A fit's key changes with codec, version, parameters, directions and values") {
  const auto btf = realistic_btf(2, "regular:3x6");
  const std::string key = fit_key(*btf, "lobes", 1, R"({"k": 2})");
  CHECK(key == fit_key(*realistic_btf(2, "regular:3x6"), "lobes", 1, R"({"k":2})"));
  CHECK(key != fit_key(*btf, "srbf", 1, R"({"k": 2})"));
  CHECK(key != fit_key(*btf, "lobes", 2, R"({"k": 2})"));
  CHECK(key != fit_key(*btf, "lobes", 1, R"({"k": 3})"));
  CHECK(key != fit_key(*realistic_btf(2, "regular:2x9"), "lobes", 1, R"({"k": 2})"));
  Btf changed = *btf;
  changed.set(3, 2, 1, 1, changed.at(3, 2, 1, 1) * 1.001F);
  CHECK(key != fit_key(changed, "lobes", 1, R"({"k": 2})"));
}
