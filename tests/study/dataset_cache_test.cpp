// Datasets for benches are traced once, kept by what they are, and continued.
#include "study/dataset_cache.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <optional>
#include <string>

#include "acquisition/mesostructure.h"
#include "btf/btf_file.h"
#include "btf/error.h"
#include "tests/temporary_folder.h"

namespace {

namespace fs = std::filesystem;

/// Sets an environment variable, or takes it away; as before at the end.
class Variable {
 public:
  Variable(const char* name, std::optional<std::string> value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~Variable() { set(before_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const std::optional<std::string>& value) {
    if (value) {
      setenv(name_, value->c_str(), 1);
    } else {
      unsetenv(name_);
    }
  }
  const char* name_;
  std::optional<std::string> before_;
};

}  // namespace

TEST_CASE("The cache is a folder of XDG_CACHE_HOME, else of HOME") {
  const Variable home("HOME", "/somewhere");
  {
    const Variable chosen("XDG_CACHE_HOME", "/caches");
    CHECK(weft::cache_folder() == fs::path("/caches/weft"));
  }
  for (const auto& unfit : {std::optional<std::string>(), {""}, {"caches"}}) {
    const Variable chosen("XDG_CACHE_HOME", unfit);
    CHECK(weft::cache_folder() == fs::path("/somewhere/.cache/weft"));
  }
  const Variable chosen("XDG_CACHE_HOME", std::nullopt);
  const Variable homeless("HOME", std::nullopt);
  CHECK_THROWS_WITH(weft::cache_folder(), Catch::Matchers::Contains("XDG_CACHE_HOME"));
}

TEST_CASE("A dataset is traced once for the same settings, and apart for others") {
  const TemporaryFolder temporary;
  const fs::path cache = temporary.path / "new" / "cache";
  const weft::Mesostructure checker = weft::read_mesostructure(
      fs::path(WEFT_SOURCE_DIR) / "scenes" / "mesostructures" / "checker.toml", {"resolution=16"});
  weft::AcquisitionSettings settings;
  settings.trace.width = settings.trace.height = 2;
  settings.trace.spp = 1;
  settings.views = settings.lights = "regular:1x3";
  weft::Progress silent;
  const fs::path first = weft::cached_dataset(cache, checker, settings, silent);
  CHECK(first.parent_path() == cache);
  CHECK(weft::read_btf_header(first).provenance == weft::provenance_of(checker, settings));
  const auto written = fs::last_write_time(first / "view_001.exr");
  CHECK(weft::cached_dataset(cache, checker, settings, silent) == first);
  CHECK(fs::last_write_time(first / "view_001.exr") == written);

  // As an interruption leaves it.
  fs::remove(first / "btf.json");
  fs::remove(first / "view_002.exr");
  CHECK(weft::cached_dataset(cache, checker, settings, silent) == first);
  CHECK(fs::exists(first / "btf.json"));
  CHECK(fs::last_write_time(first / "view_001.exr") == written);

  settings.trace.seed = 1;
  const fs::path other = weft::cached_dataset(cache, checker, settings, silent);
  CHECK(other != first);
  CHECK(fs::exists(first / "btf.json"));
}
