// weft demo in small: the whole main job runs, its page is whole, and a second run keeps what is
// there.
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <regex>
#include <set>

#include "btf/atomic_file.h"
#include "images/image_file.h"
#include "tests/cli/program.h"
#include "tests/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

double mean_of(const fs::path& picture) {
  const weft::Image image = weft::read_image(picture, weft::Encoding::colour);
  return std::accumulate(image.values.begin(), image.values.end(), 0.0) /
         static_cast<double>(image.values.size());
}

json run_demo(const fs::path& folder, const std::string& spp) {
  const Outcome outcome = run_weft({"demo",
                                    "--json",
                                    "-o",
                                    folder.string(),
                                    "--scenes",
                                    WEFT_SOURCE_DIR "/scenes",
                                    "--directions",
                                    "regular:3x6",
                                    "--texels",
                                    "4",
                                    "--size",
                                    "48",
                                    "--picture-spp",
                                    "1",
                                    "--frames",
                                    "1",
                                    "--max-bounces",
                                    "1",
                                    "--spp",
                                    spp},
                                   fs::temp_directory_path());
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  return json::parse(outcome.out);
}

}  // namespace

TEST_CASE("The demo makes three BTFs, renders each four times and writes a page that is whole",
          "[heavy]") {
  const TemporaryFolder folder;
  const json first = run_demo(folder.path, "1");
  REQUIRE(first["btfs"].size() == 3);
  for (const auto& [name, btf] : first["btfs"].items()) {
    INFO(name);
    CHECK_FALSE(btf["acquire_kept"].get<bool>());
    CHECK(btf["acquire"]["rays"].get<double>() > 0);
    CHECK(btf["cmf"]["ratio"].get<double>() > 0);
    for (const std::string renderer : {"render", "preview"}) {
      CHECK(btf["error"][renderer]["rmse"].get<double>() > 0);
    }
    CHECK(fs::exists(folder.path / "data" / (name + ".btf") / "btf.json"));
    CHECK(fs::exists(folder.path / "data" / (name + ".cmf") / "codec.json"));
  }
  CHECK(json::parse(weft::read_text(folder.path / "demo.json")) == first);

  const std::string html = weft::read_text(folder.path / "index.html");
  const std::regex source("<img src=\"([^\"]+)\"");
  std::set<std::string> pictures;
  for (std::sregex_iterator it(html.begin(), html.end(), source), end; it != end; ++it)
    pictures.insert((*it)[1]);
  CHECK(pictures.size() == 18);
  for (const std::string& picture : pictures) {
    INFO(picture);
    CHECK(mean_of(folder.path / picture) > 0.005);
  }
  // Of a coarse BTF full of noise little more can be said than that both are about equally bright.
  for (const std::string name : {"checker", "rings", "tissue"}) {
    for (const std::string renderer : {"_traced_", "_preview_"}) {
      INFO(name << renderer);
      const double raw = mean_of(folder.path / (name + renderer + "raw.png"));
      CHECK(mean_of(folder.path / (name + renderer + "cmf.png")) == Approx(raw).epsilon(0.5));
    }
  }

  const json second = run_demo(folder.path, "1");
  const json third = run_demo(folder.path, "2");
  for (const auto& [name, btf] : first["btfs"].items()) {
    INFO(name);
    CHECK(second["btfs"][name]["acquire_kept"].get<bool>());
    CHECK(second["btfs"][name]["acquire"] == btf["acquire"]);
    CHECK(second["btfs"][name]["error"] == btf["error"]);
    CHECK_FALSE(third["btfs"][name]["acquire_kept"].get<bool>());
    CHECK(third["btfs"][name]["error"] != btf["error"]);
  }
}
