// What `acquire` writes beside the values: errors, coverage, pairs off the grid; and the memory it
// takes.

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>

#include "btf/atomic_file.h"
#include "btf/btf_file.h"
#include "tests/cli/program.h"
#include "tests/temporary_folder.h"

using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

struct Place {
  TemporaryFolder folder;
  Place() {
    // Nearly flat: a value is albedo / pi cos(theta_light).
    std::ofstream(folder.path / "flat.toml")
        << "type = \"checker\"\nresolution = 16\nheight = 1e-5\n"
        << "[materials.raised]\ntype = \"lambert\"\nalbedo = [0.8, 0.5, 0.2]\n"
        << "[materials.low]\ntype = \"lambert\"\nalbedo = [0.1, 0.2, 0.7]\n";
  }
  Outcome acquire(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"acquire", "flat.toml", "-o", "a.btf"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_weft(arguments, folder.path);
  }
};

const std::vector<std::string> small = {"--texels", "6x4",         "--spp",    "16",
                                        "--views",  "regular:2x3", "--lights", "fibonacci:4"};

std::vector<std::string> with(std::vector<std::string> arguments,
                              const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

}  // namespace

TEST_CASE("acquire --validate --variance --alpha writes what the file formats say") {
  const Place place;
  const auto arguments = with(small, {"--validate", "3", "--variance", "--alpha", "0.1"});
  const Outcome outcome = place.acquire(arguments);
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const fs::path btf = place.folder.path / "a.btf";
  CHECK(files_below(btf) ==
        std::vector<std::string>{"btf.json", "offgrid", "offgrid/offgrid.json",
                                 "offgrid/pair_000.exr", "offgrid/pair_001.exr",
                                 "offgrid/pair_002.exr", "run.json", "view_000.exr", "view_001.exr",
                                 "view_002.exr", "view_003.exr", "view_004.exr", "view_005.exr"});
  for (std::size_t v = 0; v < 6; ++v) {
    const fs::path file = btf / weft::view_file_name(v);
    CHECK(weft::read_texel_errors(file, 6, 4, 4).size() == 3 * 4 * 6 * 4);
    CHECK(weft::read_coverage(file, 6, 4) == std::vector<float>(24, 0.0F));  // all below 0.1
  }
  const auto json = nlohmann::json::parse(std::ifstream(btf / "offgrid/offgrid.json"));
  CHECK(json["quantity"] == weft::traced_quantity);
  CHECK(json["texels"] == nlohmann::json::array({6, 4}));
  CHECK(json["provenance"] == nlohmann::json::parse(std::ifstream(btf / "btf.json"))["provenance"]);
  REQUIRE(json["pairs"].size() == 3);
  std::vector<double> albedos;
  for (const auto& pair : json["pairs"]) {
    INFO(pair.dump());
    // Down to the lowest direction of each: views to 67.5 degrees, lights to 89.
    CHECK(pair["view"]["theta"] <= 67.51);
    CHECK(pair["light"]["theta"] <= 89.9);
    const fs::path file = btf / "offgrid" / pair["file"].get<std::string>();
    const auto values = weft::read_view_values(file, 6, 4, 1);
    CHECK(weft::read_texel_errors(file, 6, 4, 1).size() == values.size());
    CHECK(weft::read_view_notes(file).standard_errors.size() == 1);
    CHECK(weft::read_view_header(file).pixel_type == weft::PixelType::float32);
    const double cosine = std::cos(pair["light"]["theta"].get<double>() * std::numbers::pi / 180);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (albedos.size() < values.size())
        albedos.push_back(values[i] / cosine);
      else
        CHECK(values[i] == Approx(albedos[i] * cosine).epsilon(5e-3));
    }
  }
  CHECK(json["pairs"][0]["light"] != json["pairs"][1]["light"]);
  CHECK(run_weft({"validate", "a.btf"}, place.folder.path).exit_code == 0);
  CHECK(weft::read_btf(btf).views().size() == 6);
}

TEST_CASE("a rerun keeps the pairs off the grid, and more of them begin with the same") {
  const Place place;
  const fs::path offgrid = place.folder.path / "a.btf/offgrid";
  REQUIRE(place.acquire(with(small, {"--validate", "2"})).exit_code == 0);
  const auto before = nlohmann::json::parse(std::ifstream(offgrid / "offgrid.json"));
  // Told apart from a file that is written again with the same bytes.
  const auto written = fs::last_write_time(offgrid / "pair_001.exr") - std::chrono::hours(1);
  fs::last_write_time(offgrid / "pair_001.exr", written);
  fs::remove(offgrid / "pair_000.exr");
  REQUIRE(place.acquire(with(small, {"--validate", "3"})).exit_code == 0);
  CHECK(fs::last_write_time(offgrid / "pair_001.exr") == written);
  CHECK(fs::exists(offgrid / "pair_000.exr"));
  const auto after = nlohmann::json::parse(std::ifstream(offgrid / "offgrid.json"));
  REQUIRE(after["pairs"].size() == 3);
  CHECK(after["pairs"][0] == before["pairs"][0]);
  CHECK(after["pairs"][1] == before["pairs"][1]);
}

TEST_CASE("acquire --error reports the samples that were spent, and what stayed above it") {
  const Place place;
  const Outcome outcome =
      place.acquire({"--texels", "4", "--views", "regular:1x2", "--lights", "fibonacci:4", "--spp",
                     "256", "--error", "0.5", "--json"});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const auto told = nlohmann::json::parse(outcome.out);
  CHECK(told["mean_spp"] == 20);
  CHECK(told["unsettled_percent"] == 0);
}

TEST_CASE("a dataset several times as large as --memory is traced within it", "[heavy]") {
  // 256 x 256 texels and 64 lights: 50 MB a view in floats.
  const Place place;
  const std::string scenes = std::string(WEFT_SOURCE_DIR) + "/scenes/mesostructures/";
  struct Structure {
    std::vector<std::string> arguments;
    std::string views;
  };
  const std::vector<Structure> structures = {
      {{"flat.toml"}, "regular:3x8"},  // 1.2 GB in all
      {{scenes + "checker.toml", "--set", "resolution=64"}, "regular:3x5"}};
  for (const auto& [structure, views] : structures) {
    INFO(structure.front());
    const std::vector<std::string> arguments =
        with(with({"acquire"}, structure),
             {"-o", "a.btf", "--texels", "256", "--views", views, "--lights", "fibonacci:64",
              "--spp", "1", "--max-bounces", "0", "--json", "--memory"});
    const Outcome refused = run_weft(with(arguments, {"60MiB"}), place.folder.path);
    CHECK(refused.exit_code == 2);
    CHECK_FALSE(fs::exists(place.folder.path / "a.btf"));
    const std::string words = "expected at least ";
    const auto at = refused.err.find(words);
    INFO(refused.err);
    REQUIRE(at != std::string::npos);
    const long least = std::stol(refused.err.substr(at + words.size()));
    CHECK(least > 60);
    CHECK(least < 300);
    constexpr long allowed = 8;  // over the least, so that it is not refused by chance
    constexpr long margin = 16;  // for what is not counted: compression buffers, the allocator
    const Outcome outcome =
        run_weft(with(arguments, {std::to_string(least + allowed) + "MiB"}), place.folder.path);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    CHECK(nlohmann::json::parse(outcome.out)["table_rays"] > 1'000'000);
    INFO("at least " << least << " MiB; took " << outcome.peak_kibibytes / 1024 << " MiB");
    CHECK(outcome.peak_kibibytes / 1024 < least + allowed + margin);
    CHECK(outcome.peak_kibibytes / 1024 > least / 2);
    fs::remove_all(place.folder.path / "a.btf");
  }
}

TEST_CASE("acquire --set gives the bytes of a file that says so itself") {
  const Place place;
  const fs::path& folder = place.folder.path;
  std::ifstream flat(folder / "flat.toml");
  std::string text(std::istreambuf_iterator<char>(flat), {});
  text.replace(text.find("height = 1e-5"), 13, "height = 0.15");
  text.replace(text.find("0.8, 0.5, 0.2"), 13, "0.5, 0.4, 0.3");
  std::ofstream(folder / "high.toml") << text;
  const auto bytes_of = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome =
        run_weft(with(with({"acquire"}, arguments), with(small, {"-o", "a.btf"})), folder);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    std::vector<std::string> bytes;
    for (const std::string file : {"btf.json", "view_000.exr", "view_005.exr"}) {
      std::ifstream stream(folder / "a.btf" / file, std::ios::binary);
      bytes.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    }
    fs::remove_all(folder / "a.btf");
    return bytes;
  };
  const auto high = bytes_of({"high.toml"});
  CHECK(bytes_of({"flat.toml", "--set", "height=0.15", "--set",
                  "materials.raised.albedo=[0.5, 0.4, 0.3]"}) == high);
  CHECK(bytes_of({"flat.toml"}) != high);
}

TEST_CASE("acquire --indirect cache is a dataset of its own, and for Lambert materials alone") {
  const Place place;
  const Outcome cached = place.acquire(with(small, {"--indirect", "cache", "--json"}));
  INFO(cached.err);
  REQUIRE(cached.exit_code == 0);
  CHECK(nlohmann::json::parse(cached.out)["cache_rays"] > 0);
  const auto provenance =
      nlohmann::json::parse(weft::read_btf_header(place.folder.path / "a.btf").provenance);
  CHECK(provenance["indirect"] == "cache");
  CHECK(place.acquire(small).exit_code == 2);
  const Place other;
  const Outcome glossy = other.acquire(
      with(small, {"--indirect", "cache", "--set", "materials.low.type=plastic", "--set",
                   "materials.low.ior=1.5", "--set", "materials.low.alpha=0.2"}));
  CHECK(glossy.exit_code == 2);
  CHECK_THAT(glossy.err, Contains("--indirect cache") && Contains("lambert"));
}
