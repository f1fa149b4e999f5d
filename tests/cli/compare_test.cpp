// weft compare, as a user calls it: numbers, map, exit codes.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "images/image_file.h"
#include "tests/cli/program.h"
#include "tests/cli/small_dataset.h"
#include "tests/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using weft::Image;

Outcome compare(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "compare");
  return run_weft(arguments, fs::temp_directory_path());
}

/// A folder with a grey reference, and a test that is off by 0.5 in one value of 8 x 8 x 3.
struct Pictures {
  TemporaryFolder temporary;
  fs::path folder = temporary.path;
  std::string reference = (folder / "ref.exr").string();
  std::string test = (folder / "test.exr").string();
  Pictures() {
    Image image(8, 8, 3);
    std::fill(image.values.begin(), image.values.end(), 1.0F);
    weft::write_image(reference, image, weft::Encoding::linear);
    image.values[image.offset(6, 2) + 1] = 1.5F;
    weft::write_image(test, image, weft::Encoding::linear);
  }
};

}  // namespace

TEST_CASE("compare prints what it measured as one JSON object") {
  const Pictures p;
  const Outcome outcome = compare({p.reference, p.test, "--json"});
  CHECK(outcome.exit_code == 0);
  const auto json = nlohmann::json::parse(outcome.out);
  CHECK(json["rmse"].get<double>() == Approx(std::sqrt(0.25 / 192)));
  CHECK(json["mae"].get<double>() == Approx(0.5 / 192));
  CHECK(json["psnr"].get<double>() == Approx(10 * std::log10(192 / 0.25)));
  CHECK(json["largest"]["x"] == 6);
  CHECK(json["largest"]["y"] == 2);
  CHECK(json["largest"]["channel"] == "green");
}

TEST_CASE("compare prints words for people, and equal pictures have an infinite PSNR") {
  const Pictures p;
  const Outcome outcome = compare({p.reference, p.reference});
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, Contains("SSIM           1.000000") && Contains("equal"));
  const Outcome json = compare({p.reference, p.reference, "--json"});
  CHECK(nlohmann::json::parse(json.out)["psnr"].is_null());
}

TEST_CASE("compare exits with 3 where the RMSE is above the limit, and 0 where it is not") {
  const Pictures p;
  const Outcome above = compare({"--max-rmse", "0.03", p.reference, p.test});
  CHECK(above.exit_code == 3);
  CHECK_THAT(above.err, Contains("above --max-rmse 0.03"));
  CHECK(compare({"--max-rmse", "0.04", p.reference, p.test}).exit_code == 0);
  CHECK(compare({"--max-rmse", "0", p.reference, p.reference}).exit_code == 0);
}

TEST_CASE("compare writes an error map with a legend") {
  const Pictures p;
  const std::string map = (p.folder / "map.png").string();
  CHECK(compare({"--map", map, p.reference, p.test}).exit_code == 0);
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
    const Outcome outcome = compare({p.reference, (p.folder / name).string()});
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Contains(name));
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  }
  CHECK(compare({p.reference}).exit_code == 2);
  CHECK(compare({"--max-rmse", "-1", p.reference, p.test}).exit_code == 2);
}

TEST_CASE("compare tells the error of a BTF over the pairs of light and view") {
  const TemporaryFolder temporary;
  const std::string raw = (temporary.path / "small.btf").string();
  const std::string coded = (temporary.path / "small.cmf").string();
  write_small_dataset(raw);
  REQUIRE(run_weft({"compress", raw, "--codec", "cmf", "-o", coded, "--quiet"}, temporary.path)
              .exit_code == 0);
  const Outcome equal = compare({raw, raw, "--json", "--max-rmse", "1e-6"});
  CHECK(equal.exit_code == 0);
  CHECK(nlohmann::json::parse(equal.out)["pairs"] == 49);

  const Outcome outcome = compare({raw, coded, "--json"});
  REQUIRE(outcome.exit_code == 0);
  const auto json = nlohmann::json::parse(outcome.out);
  CHECK(json["relative_rmse"].get<double>() < 0.05);
  for (const char* channel : {"y", "cb", "cr"}) {
    for (const char* measure : {"mse", "mae"}) {
      const auto& spread = json[channel][measure];
      CHECK(spread["least"].get<double>() <= spread["average"].get<double>());
      CHECK(spread["average"].get<double>() <= spread["greatest"].get<double>());
    }
  }
  // The data are grey, and so is what comes of them: all of the error is in Y.
  const double mse = json["y"]["mse"]["average"];
  CHECK(json["rmse"].get<double>() == Approx(std::sqrt(mse)).epsilon(1e-3));

  CHECK_THAT(compare({raw, coded}).out, Contains("49 pairs") && Contains("cb"));
  CHECK(compare({raw, coded, "--max-rmse", "1e-12"}).exit_code == 3);
}

TEST_CASE("compare refuses datasets that it cannot compare, in one sentence") {
  const Pictures p;
  const std::string raw = (p.folder / "small.btf").string();
  const std::string coded = (p.folder / "small.pca").string();
  write_small_dataset(raw);
  REQUIRE(
      run_weft({"compress", raw, "--codec", "pca", "-o", coded, "--quiet"}, p.folder).exit_code ==
      0);
  const auto refused = [](const std::vector<std::string>& arguments, const std::string& fragment) {
    const Outcome outcome = compare(arguments);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Contains(fragment));
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  };
  refused({raw, p.test}, "test.exr");
  refused({p.test, raw}, "small.btf");
  refused({coded, raw}, "small.pca");
  refused({raw, "missing.btf"}, "missing.btf");
  refused({raw, coded, "--map", (p.folder / "map.png").string()}, "--map");
}
