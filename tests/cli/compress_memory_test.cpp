// weft compress --memory: what it takes, what it refuses, and that a full or missing scratch folder
// ends well.

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/cli/program.h"
#include "tests/temporary_folder.h"

using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

const std::vector<std::string> codec_names = {"raw",       "cmf",  "hf",    "pca", "pca-view",
                                              "laplacian", "dfmf", "lobes", "ptm", "lafortune"};

/// A folder with a traced checker, `in.btf`.
struct Place {
  TemporaryFolder folder;

  Place(const std::string& texels, const std::string& directions) {
    std::ofstream(folder.path / "checker.toml") << "type = \"checker\"\nresolution = 16\n";
    const Outcome traced =
        run_weft({"acquire", "checker.toml", "-o", "in.btf", "--texels", texels, "--directions",
                  directions, "--spp", "1", "--max-bounces", "0"},
                 folder.path);
    INFO(traced.err);
    REQUIRE(traced.exit_code == 0);
  }

  std::vector<std::string> compress(const std::string& codec,
                                    const std::vector<std::string>& more) const {
    std::vector<std::string> words = {WEFT_BINARY, "compress", "in.btf", "--codec",
                                      codec,       "-o",       "out"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  /// Runs a command with these words before it.
  Outcome run(std::vector<std::string> before, const std::vector<std::string>& command) const {
    before.insert(before.end(), command.begin(), command.end());
    return run_program(before, folder.path);
  }

  /// The least of `--memory` in MiB, as its refusal says.
  long least_memory(const std::string& codec = "pca") const {
    const Outcome refused = run({}, compress(codec, {"--memory", "1MiB"}));
    INFO(refused.err);
    REQUIRE(refused.exit_code == 2);
    const std::string words = "at least ";
    const auto at = refused.err.find(words);
    REQUIRE(at != std::string::npos);
    return std::stol(refused.err.substr(at + words.size()));
  }
};

std::string mebibytes(long n) {
  return std::to_string(n) + "MiB";
}

}  // namespace

TEST_CASE("compress --memory: what is no size or too small is refused before anything is written") {
  const Place place("4", "regular:2x4");
  for (const char* value : {"-1", "-4GiB", "12parsecs", "much", "1.5"}) {
    const Outcome outcome = place.run({}, place.compress("pca", {"--memory", value}));
    INFO(value << ": " << outcome.err);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Contains("--memory"));
  }
  CHECK(place.least_memory() > 32);
  CHECK(!fs::exists(place.folder.path / "out"));
}

TEST_CASE("compress --memory: the same files from a scratch file, and no trace of it") {
  const Place place("48", "fibonacci:36");  // 18 MB
  const std::string memory = mebibytes(place.least_memory() + 8);
  for (const char* codec : {"pca-view", "dfmf"}) {
    REQUIRE(place.run({}, place.compress(codec, {})).exit_code == 0);
    fs::rename(place.folder.path / "out", place.folder.path / "memory");
    const Outcome outcome =
        place.run({"env", "-u", "TMPDIR"}, place.compress(codec, {"--memory", memory}));
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    const Outcome difference = place.run({"diff", "-r", "--exclude=run.json", "memory", "out"}, {});
    INFO(difference.out);
    CHECK(difference.exit_code == 0);
    fs::remove_all(place.folder.path / "memory");
    fs::remove_all(place.folder.path / "out");
  }
  CHECK(std::distance(fs::directory_iterator(place.folder.path), {}) == 2);  // in.btf, its settings
}

TEST_CASE("compress --memory: a scratch folder that is missing or full ends with 1 and one line") {
  const Place place("48", "fibonacci:36");
  const std::string memory = mebibytes(place.least_memory() + 8);
  const auto command = place.compress("pca", {"--memory", memory});
  const Outcome missing = place.run({"env", "TMPDIR=/nowhere"}, command);
  CHECK(missing.exit_code == 1);
  CHECK_THAT(missing.err, Contains("/nowhere") && Contains("TMPDIR"));
  CHECK(!fs::exists(place.folder.path / "out"));

  const std::string script =
      "mkdir disk && mount -t tmpfs -o size=64k none disk && TMPDIR=disk exec \"$@\"";
  const std::vector<std::string> small_disk = {
      "unshare", "--map-root-user", "--mount", "sh", "-c", script, "sh"};
  if (place.run({"unshare", "--map-root-user", "--mount", "true"}, {}).exit_code != 0) {
    WARN("skipped: this machine lets nobody mount a small disk");
    return;
  }
  const Outcome full = place.run(small_disk, command);
  INFO(full.err);
  CHECK(full.exit_code == 1);
  CHECK_THAT(full.err, Contains("no room") && Contains("TMPDIR") && Contains("No space left"));
  CHECK(std::ranges::count(full.err, '\n') == 1);
  CHECK(!fs::exists(place.folder.path / "out"));
}

namespace {

/// Compresses under a limit that counts all memory that no file backs.
void check_codec(const Place& place, const std::string& codec, long limit,
                 const std::vector<std::string>& options) {
  const Outcome outcome = place.run({"prlimit", "--data=" + std::to_string(limit << 20)},
                                    place.compress(codec, options));
  INFO(codec << ", " << limit << " MiB: " << outcome.err);
  CHECK(outcome.exit_code == 0);
  fs::remove_all(place.folder.path / "out");
}

// What a process has besides: data of its libraries and stacks of its threads, by Linux' count.
constexpr long margin = 80;

bool is_sanitized() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return true;
#else
  return false;
#endif
}

}  // namespace

TEST_CASE("compress --memory holds for every codec, on data several times as large", "[slow]") {
  if (is_sanitized()) {
    WARN("skipped: the sanitizer's own memory is more");
    return;
  }
  const Place place("128", "ubo81");  // 645 MB
  for (const std::string& codec : codec_names) {
    // Lobes, PTM and PCA a view make results that grow with texels times views.
    const bool a_view = codec == "lobes" || codec == "ptm" || codec == "pca-view";
    const long memory = place.least_memory(codec) + 8;
    CHECK(memory < (a_view ? 500 : 200));
    std::vector<std::string> options = {"--memory", mebibytes(memory)};
    // The maps are the same for any number of pairs: smaller ones, so that fitting them is quick.
    if (codec == "cmf" || codec == "hf") options.insert(options.end(), {"--set", "resolution=8"});
    check_codec(place, codec, memory + margin, options);
  }
}

TEST_CASE("compress --memory holds for srbf, whose texels take most", "[slow]") {
  if (is_sanitized()) {
    WARN("skipped: the sanitizer's own memory is more");
    return;
  }
  const Place place("192", "regular:2x4");
  const long memory = place.least_memory("srbf") + 8;
  CHECK(memory > 350);
  check_codec(place, "srbf", memory + margin,
              {"--memory", mebibytes(memory), "--set", "iterations=1", "--set", "starts=1"});
}

// What the program holds of its own, libraries and all, is left out: what it takes for one texel.
TEST_CASE("compress takes less than three times the raw data with every codec", "[slow]") {
  if (is_sanitized()) {
    WARN("skipped: the sanitizer's own memory is more");
    return;
  }
  const Place place("64", "ubo81");
  const Place tiny("1", "regular:2x4");
  constexpr long raw = 6L * 64 * 64 * 81 * 81;
  for (const std::string& codec : codec_names) {
    const long program = tiny.run({}, tiny.compress(codec, {})).peak_kibibytes;
    fs::remove_all(tiny.folder.path / "out");
    const Outcome outcome = place.run({}, place.compress(codec, {}));
    const long of_fit = outcome.peak_kibibytes - program;
    INFO(codec << ": " << of_fit / 1024 << " MiB of " << 3 * (raw >> 20) << ", the program "
               << program / 1024);
    CHECK(outcome.exit_code == 0);
    CHECK(of_fit * 1024 < 3 * raw);
    fs::remove_all(place.folder.path / "out");
  }
}
