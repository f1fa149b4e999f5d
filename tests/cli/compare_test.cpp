// weft compare, as a user calls it: numbers, map, exit codes.
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "images/image_file.h"

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using weft::Image;

struct Outcome {
  int exit_code;
  std::string output;  ///< stdout, and stderr where asked for
};

Outcome run(const std::string& arguments) {
  const std::string command = std::string("'" WEFT_BINARY "' ") + arguments;
  FILE* pipe = popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  Outcome outcome{0, {}};
  std::array<char, 4096> buffer;
  for (std::size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    outcome.output.append(buffer.data(), n);
  }
  outcome.exit_code = WEXITSTATUS(pclose(pipe));
  return outcome;
}

/// A folder with a grey reference, and a test that is off by 0.5 in one value of 8 x 8 x 3.
struct Pictures {
  fs::path folder =
      fs::temp_directory_path() / ("weft_compare_" + std::to_string(std::random_device{}()));
  std::string reference = (folder / "ref.exr").string();
  std::string test = (folder / "test.exr").string();
  Pictures() {
    fs::create_directories(folder);
    Image image(8, 8, 3);
    std::fill(image.values.begin(), image.values.end(), 1.0F);
    weft::write_image(reference, image, weft::Encoding::linear);
    image.values[image.offset(6, 2) + 1] = 1.5F;
    weft::write_image(test, image, weft::Encoding::linear);
  }
  ~Pictures() { fs::remove_all(folder); }
  Pictures(const Pictures&) = delete;
  Pictures& operator=(const Pictures&) = delete;
};

}  // namespace

TEST_CASE("compare prints what it measured as one JSON object") {
  const Pictures p;
  const Outcome outcome = run("compare " + p.reference + " " + p.test + " --json");
  CHECK(outcome.exit_code == 0);
  const auto json = nlohmann::json::parse(outcome.output);
  CHECK(json["rmse"].get<double>() == Approx(std::sqrt(0.25 / 192)));
  CHECK(json["mae"].get<double>() == Approx(0.5 / 192));
  CHECK(json["psnr"].get<double>() == Approx(10 * std::log10(192 / 0.25)));
  CHECK(json["largest"]["x"] == 6);
  CHECK(json["largest"]["y"] == 2);
  CHECK(json["largest"]["channel"] == "green");
}

TEST_CASE("compare prints words for people, and equal pictures have an infinite PSNR") {
  const Pictures p;
  const Outcome outcome = run("compare " + p.reference + " " + p.reference);
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.output, Contains("SSIM           1.000000") && Contains("equal"));
  CHECK(
      nlohmann::json::parse(run("compare --json " + p.reference + " " + p.reference).output)["psnr"]
          .is_null());
}

TEST_CASE("compare exits with 3 where the RMSE is above the limit, and 0 where it is not") {
  const Pictures p;
  CHECK(run("compare --quiet --max-rmse 0.03 " + p.reference + " " + p.test).exit_code == 3);
  CHECK(run("compare --quiet --max-rmse 0.04 " + p.reference + " " + p.test).exit_code == 0);
  CHECK(run("compare --quiet --max-rmse 0 " + p.reference + " " + p.reference).exit_code == 0);
  CHECK_THAT(run("compare --max-rmse 0.03 " + p.reference + " " + p.test + " 2>&1").output,
             Contains("above --max-rmse 0.03"));
}

TEST_CASE("compare writes an error map with a legend") {
  const Pictures p;
  const std::string map = (p.folder / "map.png").string();
  CHECK(run("compare --quiet --map " + map + " " + p.reference + " " + p.test).exit_code == 0);
  const Image image = weft::read_image(map, weft::Encoding::colour);
  CHECK(image.width > 8 + 40);
  CHECK(weft::mean(image.rgb(6, 2)) > weft::mean(image.rgb(0, 0)));
}

TEST_CASE("compare refuses what it cannot compare, with exit code 2 and the file's name") {
  const Pictures p;
  weft::write_image(p.folder / "small.exr", Image(4, 4, 3), weft::Encoding::linear);
  std::ofstream(p.folder / "text.exr") << "no picture";
  fs::copy_file(p.test, p.folder / "cut.exr");
  fs::resize_file(p.folder / "cut.exr", fs::file_size(p.test) / 2);
  for (const std::string name : {"small.exr", "text.exr", "cut.exr", "missing.exr"}) {
    const Outcome outcome =
        run("compare " + p.reference + " " + (p.folder / name).string() + " 2>&1");
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.output, Contains(name));
    CHECK(std::count(outcome.output.begin(), outcome.output.end(), '\n') == 1);
  }
  CHECK(run("compare " + p.reference + " 2>&1").exit_code == 2);
  CHECK(run("compare --max-rmse -1 " + p.reference + " " + p.test + " 2>&1").exit_code == 2);
}
