// weft bench codecs, as a user calls it: what it prints, and what it keeps.
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/program.h"
#include "tests/cli/small_dataset.h"
#include "tests/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using Json = nlohmann::ordered_json;

const std::vector<std::string> keys = {
    "fit_seconds", "decode_ns", "decode_batched_ns", "rmse", "relative_rmse", "bytes", "ratio"};

std::vector<std::string> names_in(const Json& object) {
  std::vector<std::string> names;
  for (const auto& [name, value] : object.items()) names.push_back(name);
  return names;
}

/// Names of all codecs, as the program itself lists them.
std::vector<std::string> registered(const fs::path& folder) {
  const Outcome outcome = run_weft({"list", "codecs", "--json"}, folder);
  const Json list = Json::parse(outcome.out)["codecs"];
  std::vector<std::string> names;
  for (const auto& codec : list) names.push_back(codec["name"]);
  return names;
}

}  // namespace

TEST_CASE("bench codecs prints an entry for each registered codec") {
  const TemporaryFolder temporary;
  write_small_dataset(temporary.path / "small.btf");
  const Outcome outcome = run_weft(
      {"bench", "codecs", "--data", "small.btf", "--no-variants", "--no-comparisons", "--json"},
      temporary.path);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.err.empty());
  const Json json = Json::parse(outcome.out);
  CHECK(json.begin().key() == "codecs");
  CHECK(names_in(json["codecs"]) == registered(temporary.path));
  for (const auto& [name, entry] : json["codecs"].items()) {
    INFO(name);
    for (const std::string& key : keys) CHECK(entry[key].is_number());
    CHECK(entry["decode_ns"].get<double>() > 0);
    CHECK(entry["decode_batched_ns"].get<double>() > 0);
  }
  CHECK(json["codecs"]["raw"]["rmse"].get<double>() < 1e-6);
  CHECK_FALSE(json["bars"].empty());
  CHECK(files_below(temporary.path).size() == 9);  // the dataset's own: nothing else is left
}

TEST_CASE("bench codecs measures one codec and its variants alone") {
  const TemporaryFolder temporary;
  write_small_dataset(temporary.path / "small.btf");
  const Outcome outcome = run_weft({"bench", "codecs", "--codec", "cmf", "--data", "small.btf",
                                    "--variant-data", "small.btf", "--json"},
                                   temporary.path);
  REQUIRE(outcome.exit_code == 0);
  const Json json = Json::parse(outcome.out);
  CHECK(names_in(json["codecs"]) == std::vector<std::string>{"cmf"});
  CHECK(json["variants"].size() > 1);
  for (const auto& [name, entry] : json["variants"].items()) {
    CHECK(entry["codec"] == "cmf");
    CHECK(entry["parameters"].is_array());
    for (const std::string& key : keys) CHECK(entry[key].is_number());
  }
  bool growth = false;
  for (const auto& bar : json["bars"]) {
    CHECK(bar["met"].is_boolean());
    CHECK(bar.contains("below") != bar.contains("at_least"));
    growth = growth || bar["what"].get<std::string>().find("256 clusters") != std::string::npos;
  }
  CHECK(growth);
}

TEST_CASE("bench codecs compares fitted codecs on several structures") {
  const TemporaryFolder temporary;
  write_small_dataset(temporary.path / "small.btf");
  const std::string cache = "XDG_CACHE_HOME=" + (temporary.path / "cache").string();
  const std::string scenes = std::string(WEFT_SOURCE_DIR) + "/scenes";
  const Outcome outcome = run_program(
      {"env",     cache,          WEFT_BINARY,   "bench",     "codecs",   "--codec", "lobes",
       "--codec", "ptm",          "--data",      "small.btf", "--texels", "2",       "--spp",
       "2",       "--directions", "regular:2x4", "--scenes",  scenes,     "--json"},
      temporary.path);
  REQUIRE(outcome.exit_code == 0);
  const Json json = Json::parse(outcome.out);
  const std::vector<std::string> structures{"checker", "rings", "tissue"};
  CHECK(names_in(json["comparisons"]) == structures);
  for (const std::string& structure : structures) {
    const Json& compared = json["comparisons"][structure]["models"];
    CHECK(compared["dataset"]["texels"] == Json({2, 2}));
    CHECK(names_in(compared["codecs"]) == std::vector<std::string>{"lobes", "ptm"});
    const double lobes = compared["codecs"]["lobes"]["luminance_difference"];
    const double ptm = compared["codecs"]["ptm"]["luminance_difference"];
    const auto told = std::ranges::count_if(json["bars"], [&](const Json& bar) {
      return bar["what"] == structure + ", lobes' luminance difference over PTM's" &&
             bar["value"] == lobes / ptm && bar["below"] == (structure == "tissue" ? 1.0 : 0.5);
    });
    CHECK(told == 1);
  }
}

TEST_CASE("bench acquire tells speeds, costs and what they are held to, and leaves no dataset") {
  const TemporaryFolder temporary;
  const std::string scenes = std::string(WEFT_SOURCE_DIR) + "/scenes";
  const Outcome outcome =
      run_program({"env", "TMPDIR=" + temporary.path.string(), WEFT_BINARY, "bench", "acquire",
                   "--structures", "checker_128,rings", "--texels", "8", "--spp", "2",
                   "--directions", "regular:2x4", "--scenes", scenes, "--json"},
                  temporary.path);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.err.empty());
  CHECK(files_below(temporary.path).empty());
  const Json json = Json::parse(outcome.out);
  CHECK(names_in(json["structures"]) == std::vector<std::string>{"checker_128", "rings"});
  for (const auto& [name, structure] : json["structures"].items()) {
    INFO(name);
    for (const std::string key :
         {"roofline_ratio", "speedup_equal_rmse", "full_dataset_seconds", "samples_per_second"})
      CHECK(structure[key].get<double>() > 0);
    // Every sample of every texel and pair, over the time.
    CHECK(structure["samples_per_second"].get<double>() ==
          Approx(64.0 * 8 * 8 * 2 / structure["full_dataset_seconds"].get<double>()));
    CHECK(structure.contains("indirect_cache") == (name == "checker_128"));  // Lambert alone
    const double goal = name == "rings" ? 40 : 120;
    CHECK(std::ranges::count_if(json["bars"], [&](const Json& bar) {
            return bar["what"] == name + ": samples a second" && bar["at_least"] == goal &&
                   bar["value"] == structure["samples_per_second"].get<double>() / 1e6;
          }) == 1);
  }
  CHECK(names_in(json["costs"]) == std::vector<std::string>{"texels", "spp", "views", "lights"});
  for (const auto& [size, rows] : json["costs"].items()) {
    REQUIRE(rows.size() == 3);
    for (const Json& row : rows) CHECK(row["seconds"].get<double>() > 0);
    const double growth = rows[2]["seconds"].get<double>() / rows[0]["seconds"].get<double>();
    CHECK(std::ranges::count_if(json["bars"], [&](const Json& bar) {
            return bar["what"] == size + " x 4: time" && bar["value"].get<double>() == growth &&
                   bar["below"] == (size == "lights" ? 3.0 : 4.0);
          }) == 1);
  }
}

TEST_CASE("bench codecs traces its dataset once, and keeps it in the cache") {
  const TemporaryFolder temporary;
  const std::string cache = "XDG_CACHE_HOME=" + (temporary.path / "cache").string();
  const auto bench = [&] {
    return run_program(
        {"env", cache, WEFT_BINARY, "bench", "codecs", "--codec", "raw", "--texels", "4", "--spp",
         "2", "--directions", "regular:2x4", "--scenes", std::string(WEFT_SOURCE_DIR) + "/scenes"},
        temporary.path);
  };
  const Outcome first = bench();
  REQUIRE(first.exit_code == 0);
  CHECK_THAT(first.out, Contains("raw") && Contains("ns batch"));
  const auto files = files_below(temporary.path / "cache" / "weft");
  REQUIRE(files.size() == 1 + 8 + 1);  // the dataset's folder, its views, btf.json
  const fs::path json = temporary.path / "cache" / "weft" / files[0] / "btf.json";
  const auto written = fs::last_write_time(json);
  CHECK(bench().exit_code == 0);
  CHECK(fs::last_write_time(json) == written);
}
