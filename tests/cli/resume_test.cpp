// Fits that are killed while they run: the same command continues from what they kept, to the bytes
// of a run that nobody disturbed.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "btf/atomic_file.h"
#include "btf/btf_file.h"
#include "btf/random.h"
#include "tests/cli/program.h"
#include "tests/temporary_folder.h"

using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

/// A gloss about a normal of its own at each texel, 8 x 8 of them.
void write_glossy_dataset(const fs::path& folder) {
  using namespace weft;
  const HemisphereSampling sampling(named_directions("regular:4x10"));
  Btf btf(8, 8, sampling, sampling, PixelType::half);
  for (int texel = 0; texel < 64; ++texel) {
    const auto tilt = [&](int axis) { return unit_float(hash_coordinates(7, texel, axis)) - 0.5F; };
    const Direction normal = Direction(tilt(0), tilt(1), 1).normalized();
    for (std::size_t view = 0; view < sampling.size(); ++view) {
      for (std::size_t light = 0; light < sampling.size(); ++light) {
        const Direction half = (sampling[light] + sampling[view]).normalized();
        const float gloss = std::pow(std::max(normal ^ half, 0.F), 30.F);
        const float value = (0.1F + gloss) * std::max(normal ^ sampling[light], 0.F);
        btf.set(light, view, texel % 8, texel / 8, Rgb(value, 0.8F * value, 0.5F * value));
      }
    }
  }
  write_btf(folder, btf);
}

struct Place {
  TemporaryFolder folder;
  Place() { write_glossy_dataset(folder.path / "a.btf"); }

  /// What `compress --json` tells of the fit.
  nlohmann::json compress(const std::string& output, const std::string& codec,
                          const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"compress", "a.btf", "--codec", codec,
                                          "-o",       output,  "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_weft(arguments, folder.path);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    CHECK(!fs::exists(folder.path / (output + ".partial")));
    return nlohmann::json::parse(outcome.out).at("fit");
  }

  /// Starts the same with one thread, and kills it when its first piece is on disk.
  /// @return how many pieces there are.
  std::ptrdiff_t kill_compress(const std::string& output, const std::string& codec,
                               const std::string& more = "") const {
    const Outcome killed =
        run_program({"sh", "-c",
                     "\"$0\" compress a.btf --threads 1 --codec " + codec + " -o " + output + " " +
                         more + " & task=$!; until set -- " + output +
                         ".partial/*.f64; [ -e \"$1\" ]; do kill -0 $task || break; sleep 0.002; "
                         "done; kill -KILL $task; wait $task",
                     WEFT_BINARY},
                    folder.path);
    INFO(killed.err);
    REQUIRE(killed.exit_code == 128 + 9);
    CHECK(!fs::exists(folder.path / output));
    const auto kept = files_below(folder.path / (output + ".partial"));
    return std::ranges::count_if(kept,
                                 [](const std::string& name) { return name.ends_with(".f64"); });
  }

  void expect_same(const std::string& a, const std::string& b) const {
    const auto names = files_below(folder.path / a);
    REQUIRE(names == files_below(folder.path / b));
    for (const std::string& name : names) {
      INFO(name);
      CHECK(weft::file_checksum(folder.path / a / name) ==
            weft::file_checksum(folder.path / b / name));
    }
  }
};

void expect_resumed(const std::string& codec, std::ptrdiff_t pieces,
                    const std::vector<std::string>& parameters) {
  const Place place;
  std::vector<std::string> more;
  std::string words;
  for (const std::string& parameter : parameters) {
    more.insert(more.end(), {"--set", parameter});
    words += " --set " + parameter;
  }
  CHECK(place.compress("whole", codec, more).at("pieces_kept") == 0);
  const std::ptrdiff_t kept = place.kill_compress("killed", codec, words);
  CHECK(kept >= 1);
  CHECK(kept < pieces);
  CHECK(place.compress("killed", codec, more).at("pieces_kept") == kept);
  place.expect_same("whole", "killed");
}

}  // namespace

TEST_CASE("A fit of lobes that is killed with SIGKILL continues to the bytes of one run") {
  expect_resumed("lobes", 40, {"lobes=4"});
}

TEST_CASE("A fit of Lafortune models that is killed with SIGKILL continues to the same bytes") {
  expect_resumed("lafortune", 8, {"lobes=3"});
}

TEST_CASE("A fit of SRBFs that is killed with SIGKILL continues to the bytes of one run") {
  expect_resumed("srbf", 8, {"kernels=3", "iterations=10", "starts=1"});
}

TEST_CASE("What a killed fit of other parameters left is not taken, and goes") {
  const Place place;
  place.compress("whole", "lobes");
  CHECK(place.kill_compress("killed", "lobes", "--set lobes=4") >= 1);
  CHECK(place.compress("killed", "lobes").at("pieces_kept") == 0);
  place.expect_same("whole", "killed");
}

TEST_CASE("compress refuses to keep a fit where something else lies, and leaves it there") {
  const Place place;
  fs::create_directories(place.folder.path / "c.lobes.partial");
  std::ofstream(place.folder.path / "c.lobes.partial" / "letter.txt") << "dear";
  const Outcome refused =
      run_weft({"compress", "a.btf", "--codec", "lobes", "-o", "c.lobes"}, place.folder.path);
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("c.lobes.partial"));
  CHECK(fs::exists(place.folder.path / "c.lobes.partial" / "letter.txt"));
}
