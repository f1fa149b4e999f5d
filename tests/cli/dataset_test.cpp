// info, extract and validate on a dataset whose values are known, and on what damage does to it.

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "images/image_file.h"
#include "tests/cli/program.h"
#include "tests/cli/small_dataset.h"
#include "tests/temporary_folder.h"

using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

struct Dataset {
  TemporaryFolder folder;
  Dataset() { write_small_dataset(folder.path / "small.btf"); }
  Outcome run(const std::vector<std::string>& arguments) const {
    return run_weft(arguments, folder.path);
  }
  nlohmann::json json(std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    return nlohmann::json::parse(run(arguments).out);
  }
};

}  // namespace

TEST_CASE("info tells the sizes of a raw and of a compressed dataset") {
  const Dataset dataset;
  const auto raw = dataset.json({"info", "small.btf"});
  CHECK(raw["codec"] == "raw");
  CHECK(raw["texels"] == nlohmann::json::array({4, 2}));
  CHECK(raw["views"]["count"] == 7);
  CHECK(raw["lights"]["largest_theta"].get<double>() == Approx(50).margin(1e-4));
  // Of the mip levels 4 x 2, 2 x 1 and 1 x 1.
  CHECK(raw["bytes"] == (8 + 2 + 1) * 7 * 7 * 3 * sizeof(float));
  CHECK(raw["ratio"].get<double>() == Approx(8.0 / 11 / sizeof(float)));

  REQUIRE(dataset.run({"compress", "small.btf", "--codec", "cmf", "-o", "small.cmf"}).exit_code ==
          0);
  const auto compressed = dataset.json({"info", "small.cmf"});
  CHECK(compressed["codec"] == "cmf");
  CHECK(compressed["texels"] == raw["texels"]);
  CHECK(compressed["ratio"].get<double>() ==
        Approx(3.0 * 4 * 2 * 7 * 7 / compressed["bytes"].get<double>()));
  CHECK(compressed.contains("parameters"));
}

TEST_CASE("info --asymmetry tells the energies of a texel's light fields and reflectance fields") {
  const Dataset dataset;
  // Column 2 of the upper row: albedo 0.7.
  const auto told =
      dataset.json({"info", "small.btf", "--asymmetry", "--texel", "2,0"})["asymmetry"];
  CHECK(told["texel"] == nlohmann::json::array({2, 0}));
  CHECK(told["asymmetry"].get<double>() == Approx(0).margin(1e-5));
  for (const char* fields : {"light_fields", "reflectance_fields"}) {
    CHECK(told[fields]["roughness"].get<double>() == Approx(0).margin(1e-5));
    REQUIRE(told[fields]["theta_phi_energy"].size() == 7);
    for (const auto& row : told[fields]["theta_phi_energy"])
      CHECK(row[2].get<double>() == Approx(7 * 0.7 / std::numbers::pi).epsilon(1e-4));
  }
  CHECK_THAT(dataset.run({"info", "small.btf", "--asymmetry"}).out, Contains("theta_v"));
  const Outcome outside = dataset.run({"info", "small.btf", "--asymmetry", "--texel", "4,0"});
  CHECK(outside.exit_code == 2);
  CHECK_THAT(outside.err, Contains("4,0") && Contains("4 x 2"));
  CHECK(outside.out.empty());
  REQUIRE(dataset.run({"compress", "small.btf", "--codec", "ptm", "-o", "small.ptm"}).exit_code ==
          0);
  const Outcome compressed = dataset.run({"info", "small.ptm", "--asymmetry"});
  CHECK(compressed.exit_code == 2);
  CHECK_THAT(compressed.err, Contains("small.ptm") && Contains("raw"));
  CHECK(compressed.out.empty());
}

TEST_CASE("extract writes the values of one view and one light, +y up") {
  const Dataset dataset;
  const auto told =
      dataset.json({"extract", "small.btf", "--view", "20,100", "--light", "40,15", "-o", "a.exr"});
  CHECK(told["size"] == nlohmann::json::array({4, 2}));
  const weft::Image image = weft::read_image(dataset.folder.path / "a.exr", weft::Encoding::linear);
  REQUIRE(image.width == 4);
  REQUIRE(image.height == 2);
  const double cosine = std::cos(40 * std::numbers::pi / 180);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) {
      const double albedo = 0.1 * ((1 - y) * 4 + x + 1);
      CHECK(image.rgb(x, y).y == Approx(albedo / std::numbers::pi * cosine).epsilon(1e-3));
    }
  }
  CHECK(dataset.json({"extract", "small.btf", "--view", "0,0", "--light", "0,0", "-o", "b.png",
                      "--size", "16x8"})["size"] == nlohmann::json::array({16, 8}));
  CHECK(fs::exists(dataset.folder.path / "b.png"));
}

TEST_CASE("extract writes a compressed dataset's answers, as near to the raw ones as the fit is") {
  const Dataset dataset;
  REQUIRE(dataset.run({"compress", "small.btf", "--codec", "cmf", "-o", "small.cmf"}).exit_code ==
          0);
  const auto picture = [&](const std::string& input) {
    const auto told =
        dataset.json({"extract", input, "--view", "20,100", "--light", "40,15", "-o", "a.exr"});
    CHECK(told["size"] == nlohmann::json::array({4, 2}));
    CHECK(told["codec"] == (input == "small.btf" ? "raw" : "cmf"));
    weft::Image image = weft::read_image(dataset.folder.path / "a.exr", weft::Encoding::linear);
    REQUIRE(image.values.size() == 4 * 2 * 3);
    double sum = 0;
    for (const float value : image.values) sum += value;
    CHECK(told["mean"][0].get<double>() == Approx(sum / 24).epsilon(1e-5));  // it is grey
    return image;
  };
  const weft::Image raw = picture("small.btf");
  const weft::Image fitted = picture("small.cmf");
  // The data are one product of a texel's albedo and a light's cosine, which a chain of factors
  // holds: what is left is the rounding to 8 bits.
  for (std::size_t i = 0; i < raw.values.size(); ++i) {
    INFO("value " << i);
    CHECK(fitted.values[i] == Approx(raw.values[i]).epsilon(0.015));
  }
}

TEST_CASE("extract rounds a level's size down, as the levels themselves do") {
  const TemporaryFolder folder;
  const weft::HemisphereSampling up({{0, 0, 1}});
  weft::write_btf(folder.path / "five.btf", weft::Btf(5, 5, up, up, weft::PixelType::half));
  const Outcome outcome = run_weft({"extract", "five.btf", "--view", "0,0", "--light", "0,0", "-o",
                                    "a.exr", "--lod", "1", "--json"},
                                   folder.path);
  CHECK(nlohmann::json::parse(outcome.out)["size"] == nlohmann::json::array({2, 2}));
}

TEST_CASE("compress refuses a folder that it may not replace before it reads anything") {
  const TemporaryFolder folder;
  fs::create_directory(folder.path / "mine");
  std::ofstream(folder.path / "mine" / "letter.txt") << "dear";
  const Outcome outcome = run_weft({"compress", "none.btf", "-o", "mine"}, folder.path);
  CHECK(outcome.exit_code == 2);
  CHECK_THAT(outcome.err, Contains("mine"));
}

TEST_CASE("extract refuses what it cannot do, and leaves no picture") {
  const Dataset dataset;
  for (const auto& [bad, word] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--view", "90,0", "--light", "0,0"}, "--view"},
           {{"--view", "0,0", "--light", "-5,0"}, "--light"},
           {{"--view", "0,0", "--light", "nan,0"}, "--light"},
           {{"--view", "0,0", "--light", "0,0", "--size", "64"}, "--size"},
           {{"--view", "0,0", "--light", "0,0", "--size", "0x4"}, "--size"},
           {{"--view", "0", "--light", "0,0"}, "--view"}}) {
    std::vector<std::string> arguments = {"extract", "small.btf", "-o", "c.exr"};
    arguments.insert(arguments.end(), bad.begin(), bad.end());
    const Outcome outcome = dataset.run(arguments);
    INFO(outcome.err);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Contains(word));
    CHECK(!fs::exists(dataset.folder.path / "c.exr"));
  }
}

TEST_CASE("validate finds nothing in a whole dataset") {
  const Dataset dataset;
  REQUIRE(dataset.run({"compress", "small.btf", "--codec", "cmf", "-o", "small.cmf"}).exit_code ==
          0);
  for (const char* name : {"small.btf", "small.cmf"}) {
    const auto told = dataset.json({"validate", name});
    CHECK(told["findings"].empty());
    CHECK(told["values_decoded"] == 4 * 2 * 7 * 7);
    CHECK(dataset.run({"validate", name}).exit_code == 0);
  }
}

TEST_CASE("validate ends with 3 and names the file that was damaged") {
  const Dataset dataset;
  const fs::path view = dataset.folder.path / "small.btf" / "view_003.exr";
  SECTION("one byte") {
    std::fstream file(view, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(-1, std::ios::end);
    const char last = static_cast<char>(file.get());
    file.seekp(-1, std::ios::end);
    file.put(static_cast<char>(last ^ 1));
  }
  SECTION("truncated") {
    fs::resize_file(view, fs::file_size(view) / 2);
  }
  SECTION("removed") {
    fs::remove(view);
  }
  const Outcome outcome = dataset.run({"validate", "small.btf"});
  CHECK(outcome.exit_code == 3);
  CHECK_THAT(outcome.err, Contains("view_003.exr"));
}

TEST_CASE("validate ends with 3 and says what a dataset would have") {
  const Dataset dataset;
  fs::remove(dataset.folder.path / "small.btf" / "btf.json");
  const Outcome outcome = dataset.run({"validate", "small.btf"});
  CHECK(outcome.exit_code == 3);
  CHECK_THAT(outcome.err, Contains("weft: 1: ") && Contains("btf.json") && Contains("codec.json"));
  CHECK_THAT(outcome.out, Contains("1 finding\n"));
}

TEST_CASE("validate ends with 3 where the JSON is half a file") {
  const Dataset dataset;
  const fs::path json = dataset.folder.path / "small.btf" / "btf.json";
  fs::resize_file(json, fs::file_size(json) / 2);
  const Outcome outcome = dataset.run({"validate", "small.btf"});
  CHECK(outcome.exit_code == 3);
  CHECK_THAT(outcome.err, Contains("btf.json"));
  CHECK(dataset.run({"validate", "nothing.btf"}).exit_code == 2);
}

TEST_CASE("compress hands the global seed only to a codec that draws random numbers") {
  const Dataset dataset;
  for (const std::string& codec : {std::string("raw"), std::string("cmf")}) {
    INFO(codec);
    const Outcome outcome = dataset.run(
        {"compress", "small.btf", "--codec", codec, "--seed", "3", "-o", "out." + codec});
    CHECK(outcome.err.find("unknown") == std::string::npos);
    CHECK(outcome.exit_code == 0);
  }
  CHECK(dataset.run({"compress", "small.btf", "--codec", "raw", "--set", "seed=3", "-o", "out.btf"})
            .exit_code == 2);
}

TEST_CASE("info tells the span of a matrix to people, and all of it with --json") {
  const Dataset dataset;
  const fs::path path = dataset.folder.path / "small.btf" / "btf.json";
  auto description = nlohmann::json::parse(std::ifstream(path));
  std::vector<std::vector<double>> noise(7, std::vector<double>(7, 0.25));
  noise[2][3] = 0.74;
  description["noise"]["standard_error_of_pair_means"] = noise;
  std::ofstream(path) << description.dump();
  CHECK_THAT(dataset.run({"info", "small.btf"}).out,
             Contains("49 numbers: least 0.25, mean 0.26, largest 0.74"));
  CHECK(dataset.json({"info", "small.btf"})["noise"]["standard_error_of_pair_means"] == noise);
}
