// Shards of an acquisition, as a batch system runs them: killed, repeated, finished too early.

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "btf/atomic_file.h"
#include "tests/cli/program.h"
#include "tests/temporary_folder.h"

using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

struct Place {
  TemporaryFolder folder;
  Place() {
    std::ofstream(folder.path / "checker.toml") << "type = \"checker\"\nresolution = 16\n";
  }
  Outcome acquire(const std::string& output, const std::vector<std::string>& more,
                  const std::string& directions = "regular:2x3", const char* texels = "8",
                  const char* spp = "1") const {
    std::vector<std::string> arguments = {"acquire",      "checker.toml", "-o",    output,
                                          "--texels",     texels,         "--spp", spp,
                                          "--directions", directions};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_weft(arguments, folder.path);
  }
  /// Names of the files that are data, sorted; the records of runs are not.
  std::vector<std::string> data(const std::string& output) const {
    std::vector<std::string> names = files_below(folder.path / output);
    std::erase_if(names, [](const std::string& name) { return name.starts_with("run"); });
    return names;
  }
  void expect_same(const std::string& a, const std::string& b) const {
    REQUIRE(data(a) == data(b));
    for (const std::string& name : data(a)) {
      INFO(name);
      CHECK(weft::file_checksum(folder.path / a / name) ==
            weft::file_checksum(folder.path / b / name));
    }
  }
};

}  // namespace

TEST_CASE("A shard that is killed with SIGKILL and run again gives the bytes of one run",
          "[heavy]") {
  const Place place;
  // So many samples that there is a visibility table, which each run makes anew.
  const auto acquire = [&](const char* output, const std::vector<std::string>& more) {
    return place.acquire(output, more, "ubo81", "16", "16");
  };
  const Outcome whole = acquire("a.btf", {"--json"});
  REQUIRE(whole.exit_code == 0);
  CHECK(nlohmann::json::parse(whole.out)["table_rays"] > 0);
  const Outcome killed = run_program(
      {"sh", "-c",
       "\"$0\" acquire checker.toml -o b.btf --texels 16 --spp 16 --shard 0/2 --threads 1 & "
       "task=$!; until ls b.btf/view_*.exr; do sleep 0.01; done; kill -KILL $task; wait $task",
       WEFT_BINARY},
      place.folder.path);
  REQUIRE(killed.exit_code == 128 + 9);
  const auto half = place.data("b.btf");
  const auto views = std::ranges::count_if(half, [](auto& n) { return n.starts_with("view_"); });
  CHECK(views >= 1);
  CHECK(views < 41);
  CHECK(std::ranges::find(half, "btf.json") == half.end());

  REQUIRE(acquire("b.btf", {"--shard", "1/2"}).exit_code == 0);
  const Outcome again = acquire("b.btf", {"--shard", "0/2", "--json"});
  REQUIRE(again.exit_code == 0);
  CHECK(nlohmann::json::parse(again.out)["views_kept"] == views);
  REQUIRE(acquire("b.btf", {"--finish"}).exit_code == 0);
  place.expect_same("a.btf", "b.btf");
}

TEST_CASE("Shards that run at once in one folder give the bytes of one run") {
  const Place place;
  REQUIRE(place.acquire("a.btf", {}).exit_code == 0);
  const Outcome all = run_program(
      {"sh", "-c",
       "for i in 0 1 2 1; do \"$0\" acquire checker.toml -o b.btf --texels 8 --spp 1 --directions "
       "regular:2x3 --shard $i/3 & tasks=\"$tasks $!\"; done; for i in $tasks; do wait $i || exit "
       "1; done",
       WEFT_BINARY},
      place.folder.path);
  INFO(all.err);
  REQUIRE(all.exit_code == 0);
  REQUIRE(place.acquire("b.btf", {"--finish"}).exit_code == 0);
  place.expect_same("a.btf", "b.btf");
}

TEST_CASE("Finishing too early ends with 1, names the missing views, and changes nothing") {
  const Place place;
  const Outcome nothing = place.acquire("b.btf", {"--finish"});
  CHECK(nothing.exit_code == 1);
  CHECK_FALSE(fs::exists(place.folder.path / "b.btf"));
  REQUIRE(place.acquire("b.btf", {"--shard", "2/3"}).exit_code == 0);
  const auto before = files_below(place.folder.path);
  const Outcome early = place.acquire("b.btf", {"--finish", "--json"});
  CHECK(early.exit_code == 1);
  CHECK_THAT(early.err, Contains("view_000.exr, view_001.exr, view_003.exr, view_004.exr yet"));
  CHECK(nlohmann::json::parse(early.out)["missing_views"] == nlohmann::json::array({0, 1, 3, 4}));
  CHECK(files_below(place.folder.path) == before);
}

TEST_CASE("Shards and finishing of other settings are refused with 2") {
  const Place place;
  REQUIRE(place.acquire("b.btf", {"--shard", "2/3"}).exit_code == 0);
  const auto before = files_below(place.folder.path);
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--shard", "1/3", "--seed", "7"},
        std::vector<std::string>{"--finish", "--seed", "7"}}) {
    const Outcome outcome = place.acquire("b.btf", more);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Contains("b.btf") && Contains("other settings") && Contains("/seed"));
  }
  CHECK(files_below(place.folder.path) == before);
}

TEST_CASE("Each shard keeps a record of its runs, and the dataset of its own") {
  const Place place;
  REQUIRE(place.acquire("b.btf", {"--shard", "1/2"}).exit_code == 0);
  REQUIRE(place.acquire("b.btf", {"--shard", "1/2"}).exit_code == 0);
  REQUIRE(place.acquire("b.btf", {}).exit_code == 0);
  const auto record = [&](const char* name) {
    return nlohmann::json::parse(std::ifstream(place.folder.path / "b.btf" / name));
  };
  const auto shard = record("run_1of2.json");
  REQUIRE(shard.size() == 2);
  CHECK(shard[0]["measured"]["views_kept"] == 0);
  CHECK(shard[1]["measured"]["views_kept"] == 3);
  CHECK_THAT(shard[1]["command"].get<std::string>(), Contains("--shard 1/2"));
  REQUIRE(record("run.json").size() == 1);
  CHECK(run_weft({"validate", "b.btf"}, place.folder.path).exit_code == 0);
}
