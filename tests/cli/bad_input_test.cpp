// What a user may get wrong ends in one sentence that names the place, exit 2, and nothing left
// behind.

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <limits>

#include "images/image_file.h"
#include "tests/cli/program.h"
#include "tests/cli/small_dataset.h"
#include "tests/temporary_folder.h"

using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

void write(const fs::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

/// A folder with one of every mistake.
struct Mistakes {
  TemporaryFolder folder;

  Mistakes() {
    const fs::path& f = folder.path;
    write(f / "good.toml", "type = \"checker\"\nresolution = 16\n");
    write(f / "half.toml", "type = \"checker\"\nheight = ");
    write(f / "unknown.toml", "type = \"checker\"\nhight = 0.1\n");
    write(f / "type.toml", "type = \"chequer\"\n");
    write(f / "nan.toml", "type = \"heightfield\"\nfile = \"nan.exr\"\nheight = 0.1\n");
    write(f / "truncated.toml", "type = \"heightfield\"\nfile = \"truncated.exr\"\nheight = 0.1\n");
    write(f / "faceless.toml", "type = \"mesh\"\nfile = \"faceless.obj\"\n");
    write(f / "fileless.toml", "type = \"mesh\"\nfile = \"nothing.obj\"\n");
    write(f / "faceless.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\n");
    write(f / "thin.toml", "type = \"mesh\"\nfile = \"thin.obj\"\n");
    write(f / "thin.obj", "v 0 0 0\nv 0.5 0 0\nv 1 0 0\nf 1 2 3\n");
    write(f / "empty.csv", "theta,phi\n");
    fs::create_directory(f / "torn.btf");
    write(f / "torn.btf" / "btf.json", "{\n \"format\": \"weft-btf\",\n \"version\": ");
    fs::create_directory(f / "odd.btf");
    write(f / "odd.btf" / "btf.json", "{\n \"format\" 1}");
    write(f / "scene.toml",
          "camera = { type = \"perspective\", eye = [0, -4, 2], target = [0, 0, 0], up = [0, 0, "
          "1], fov = 40, "
          "size = [8, 8] }\n"
          "shape = [ { type = \"sphere\", material = \"weave\" } ]\n"
          "light = [ { type = \"point\", position = [2, -2, 4], intensity = [40, 40, 40] } ]\n"
          "[material.weave]\ntype = \"btf\"\nfile = \"nothing.btf\"\n");
    weft::Image heights(8, 8, 3);
    weft::write_image(f / "truncated.exr", heights, weft::Encoding::linear);
    fs::resize_file(f / "truncated.exr", fs::file_size(f / "truncated.exr") - 40);
    heights.values[heights.offset(3, 5)] = std::numeric_limits<float>::quiet_NaN();
    weft::write_image(f / "nan.exr", heights, weft::Encoding::linear);
    write_small_dataset(f / "small.btf");
    fs::copy(f / "small.btf", f / "cut.btf");
    fs::resize_file(f / "cut.btf" / "view_002.exr", 300);
    fs::create_directory(f / "fitted.cmf");
    write(f / "fitted.cmf" / "codec.json", "{}");
    write(f / "imageless.toml", "type = \"heightfield\"\nfile = \"none.png\"\n");
    write(f / "mirror.toml",
          "type = \"rings\"\nsegments = 8\nminor_segments = 8\n[materials.default]\ntype = "
          "\"conductor\"\nalpha = 1e-4\n");
  }

  /// @param fragments  what the sentence must name.
  void refused(const std::vector<std::string>& arguments,
               const std::vector<std::string>& fragments) const {
    const auto before = files_below(folder.path);
    const Outcome outcome = run_weft(arguments, folder.path);
    INFO(arguments[0] << " " << arguments[1] << ": " << outcome.err << outcome.out);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.err.starts_with("weft: "));
    CHECK(std::ranges::count(outcome.err, '\n') == 1);
    CHECK(outcome.out.empty());
    for (const std::string& fragment : fragments) CHECK_THAT(outcome.err, Contains(fragment));
    CHECK(files_below(folder.path) == before);
  }
};

std::vector<std::string> acquire(const std::string& file,
                                 const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"acquire",  file, "-o",           "out.btf",
                                        "--texels", "4",  "--directions", "regular:1x2"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

}  // namespace

TEST_CASE("acquire refuses bad mesostructures") {
  const Mistakes mistakes;
  mistakes.refused(acquire("nothing.toml"), {"nothing.toml"});
  mistakes.refused(acquire("half.toml"), {"half.toml:2"});
  mistakes.refused(acquire("unknown.toml"), {"unknown.toml:2", "hight", "height"});
  mistakes.refused(acquire("type.toml"), {"type.toml:1", "chequer", "checker"});
  mistakes.refused(acquire("nan.toml"), {"nan.exr", "height of pixel"});
  mistakes.refused(acquire("truncated.toml"), {"truncated.exr", "cannot be read"});
  mistakes.refused(acquire("faceless.toml"), {"faceless.obj", "no faces"});
  mistakes.refused(acquire("thin.toml"), {"thin.obj", "no triangle with an area"});
  mistakes.refused(acquire("fileless.toml"), {"fileless.toml:2:1", "nothing.obj"});
  mistakes.refused(acquire("imageless.toml"), {"imageless.toml:2:1", "none.png"});
  mistakes.refused(acquire("good.toml", {"--set", "reference_height=-0.5"}),
                   {"reference_height", "-0.5", "lowest"});
  // A highlight that no half holds.
  mistakes.refused(acquire("mirror.toml", {"--max-bounces", "0"}), {"half"});
}

TEST_CASE("acquire refuses bad options") {
  const Mistakes mistakes;
  mistakes.refused(acquire("good.toml", {"--spp", "0"}), {"spp", "0"});
  mistakes.refused(acquire("good.toml", {"--spp", "1e9"}),
                   {"--spp", "'1e9'", "a whole number from 1 to"});
  mistakes.refused(acquire("good.toml", {"--views", "file:empty.csv"}),
                   {"empty.csv", "0 directions", "1 to 16000"});
  mistakes.refused(acquire("good.toml", {"--max-bounces", "many"}), {"--max-bounces", "many"});
  mistakes.refused(acquire("good.toml", {"--max-bounces", "inf"}),
                   {"--max-bounces", "inf", "unlimited"});
  mistakes.refused(acquire("good.toml", {"--views", "ubo18"}), {"ubo18", "ubo81"});
  mistakes.refused(acquire("good.toml", {"--pixel", "byte"}), {"--pixel", "byte", "half"});
  mistakes.refused(acquire("good.toml", {"--set", "hight=1"}), {"hight", "height"});
}

TEST_CASE("acquire refuses places where no dataset can be") {
  const Mistakes mistakes;
  const auto refused = [&](const std::string& place, const std::vector<std::string>& fragments) {
    mistakes.refused(
        {"acquire", "good.toml", "--texels", "4", "--directions", "regular:1x2", "-o", place},
        fragments);
  };
  refused("fitted.cmf", {"fitted.cmf", "codec.json"});
  refused("half.toml", {"half.toml", "file"});
  refused("", {"--output", "empty"});
}

TEST_CASE("acquire refuses errors, heights, pairs and memory that cannot be") {
  const Mistakes mistakes;
  const auto refused = [&](const std::vector<std::string>& more,
                           const std::vector<std::string>& fragments) {
    mistakes.refused(acquire("good.toml", more), fragments);
  };
  refused({"--error", "-0.01"}, {"--error", "-0.01", "expected"});
  refused({"--error", "nan"}, {"--error", "nan"});
  refused({"--error", "small"}, {"--error", "small"});
  refused({"--error", "0.01", "--spp", "1"}, {"--spp", "1", "at least 2"});
  refused({"--variance", "--spp", "1"}, {"--spp", "1", "at least 2"});
  refused({"--alpha", "nan"}, {"--alpha", "nan", "height"});
  refused({"--alpha", "high"}, {"--alpha", "high"});
  refused({"--validate", "-1"}, {"--validate", "-1"});
  refused({"--validate", "some"}, {"--validate", "'some'", "a whole number from 0 to"});
  refused({"--validate", "2", "--shard", "0/2"}, {"--validate", "--shard"});
  refused({"--validate", "2", "--finish"}, {"--validate", "--finish"});
  refused({"--memory", "-1"}, {"--memory", "-1"});
  refused({"--memory", "4 apples"}, {"--memory", "apples", "gib"});
  refused({"--memory", "1MiB"}, {"--memory", "is 1 MiB", "at least", "MiB"});
}

TEST_CASE("acquire refuses shards that are none") {
  const Mistakes mistakes;
  const auto refused = [&](const std::string& shard, const std::vector<std::string>& fragments) {
    mistakes.refused(acquire("good.toml", {"--shard", shard}), fragments);
  };
  refused("3", {"--shard", "\"3\"", "I/N", "0/8"});
  refused("3/3", {"--shard", "from 0", "\"3\"", "0 to 2"});
  refused("-1/3", {"--shard", "\"-1\"", "0 to 2"});
  refused("0/0", {"--shard", "N of I/N", "\"0\"", "from 1"});
  refused("1/2/3", {"--shard", "\"2/3\""});
  refused("one/2", {"--shard", "\"one\""});
  refused("/2", {"--shard", "I of I/N"});
  refused("1/", {"--shard", "N of I/N"});
  refused("1/99999999999", {"--shard", "N of I/N"});
  mistakes.refused(acquire("good.toml", {"--shard", "0/2", "--finish"}), {"--shard", "--finish"});
}

TEST_CASE("compress, info and extract refuse what is not a dataset") {
  const Mistakes mistakes;
  mistakes.refused({"info", "nothing.btf"}, {"nothing.btf"});
  mistakes.refused({"info", "good.toml"}, {"good.toml"});
  mistakes.refused({"info", "torn.btf"}, {"torn.btf/btf.json:3:13: is not JSON", "ends here"});
  mistakes.refused({"compress", "odd.btf", "-o", "out.cmf"},
                   {"odd.btf/btf.json:2:11: is not JSON"});
  mistakes.refused({"extract", "cut.btf", "--view", "0,0", "--light", "0,0", "-o", "a.exr"},
                   {"view_002.exr"});
  mistakes.refused({"compress", "nothing.btf", "-o", "out.cmf"}, {"nothing.btf"});
  mistakes.refused({"compress", "fitted.cmf", "-o", "out.cmf"}, {"fitted.cmf", "already"});
  mistakes.refused({"compress", "cut.btf", "-o", "out.cmf"}, {"view_002.exr"});
  mistakes.refused({"compress", "small.btf", "--codec", "cfm", "-o", "out.cmf"}, {"cfm", "cmf"});
  mistakes.refused({"compress", "small.btf", "-o", "out.cmf", "--set", "bit=8"}, {"bit", "bits"});
}

TEST_CASE("render and preview refuse bad scenes") {
  const Mistakes mistakes;
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"render"}, std::vector<std::string>{"preview", "--headless"}}) {
    const auto refused = [&](const std::vector<std::string>& more,
                             const std::vector<std::string>& fragments) {
      std::vector<std::string> arguments = command;
      arguments.insert(arguments.end(), more.begin(), more.end());
      mistakes.refused(arguments, fragments);
    };
    refused({"nothing.toml", "-o", "a.exr"}, {"nothing.toml"});
    refused({"half.toml", "-o", "a.exr"}, {"half.toml:2"});
    refused({"scene.toml", "-o", "a.exr"}, {"nothing.btf"});
    refused({"scene.toml", "-o", "a.exr", "--btf", "cut.btf"}, {"view_002.exr"});
    refused({"scene.toml", "-o", "a.exr", "--btf", "small.btf", "--set", "camera.fof=3"},
            {"fof", "fov"});
  }
  mistakes.refused({"render", "scene.toml", "--btf", "small.btf", "-o", "a.exr", "--spp", "0"},
                   {"--spp", "0"});
}

TEST_CASE("A picture that cannot be written is refused before the work") {
  const Mistakes mistakes;
  const std::vector<std::vector<std::string>> commands = {
      {"render", "scene.toml", "-o"},
      {"render", "scene.toml", "-o", "a.exr", "--variance"},
      {"preview", "--headless", "scene.toml", "-o"},
      {"preview", "scene.toml", "--screenshot"},
      {"extract", "nothing.btf", "--view", "0,0", "--light", "0,0", "-o"},
      {"compare", "nothing.exr", "nothing.exr", "--map"}};
  for (const std::vector<std::string>& command : commands) {
    const auto refused = [&](const std::string& path, const std::string& word) {
      std::vector<std::string> arguments = command;
      arguments.push_back(path);
      mistakes.refused(arguments, {"weft: " + path + ": ", word});
    };
    refused("nodir/a.exr", "nodir");
    refused("a.exx", "exx");
    refused("small.btf", "folder");
  }
}

TEST_CASE("preview refuses a size that no picture has") {
  const Mistakes mistakes;
  mistakes.refused({"preview", "--headless", "scene.toml", "--btf", "small.btf", "-o", "a.exr",
                    "--size", "9999999x2"},
                   {"--size", "9999999x2", "16384"});
}

TEST_CASE("The demo refuses to compress with raw before it traces") {
  const Mistakes mistakes;
  mistakes.refused({"demo", "--codec", "raw", "-o", "demo"}, {"--codec", "raw", "cmf"});
}

TEST_CASE("bench refuses what it cannot measure, before it measures anything") {
  const Mistakes mistakes;
  const std::string scenes = std::string(WEFT_SOURCE_DIR) + "/scenes";
  const auto refused = [&](const std::vector<std::string>& more,
                           const std::vector<std::string>& fragments) {
    std::vector<std::string> arguments = {"bench", "acquire", "--scenes", scenes};
    arguments.insert(arguments.end(), more.begin(), more.end());
    mistakes.refused(arguments, fragments);
  };
  const std::string all = "checker, checker_128, checker_glossy, rings, tissue";
  refused({"--structures", "rings,checkers"}, {"--structures", "'checkers'", "'checker'", all});
  refused({"--structures", "good.toml"}, {"--structures", "'good.toml'", all});
  refused({"--structures", ""}, {"--structures", "''", all});
  refused({"--structures", "rings,rings"}, {"--structures", "'rings' twice"});
  refused({"--texels", "-4"}, {"--texels", "'-4'", "from 1 to"});
  refused({"--texels", "0"}, {"--texels", "'0'", "from 1 to"});
  refused({"--spp", "1"}, {"--spp", "'1'", "from 2 to"});
  refused({"--spp", "2.5"}, {"--spp", "'2.5'", "whole number"});
  refused({"--directions", "ubo18"}, {"directions", "ubo18", "ubo81"});
  refused({"--directions", "file:"}, {"directions", "file:", "ubo81"});
  mistakes.refused({"bench", "acquire", "--scenes", "nothing"}, {"nothing", "folder"});
  mistakes.refused({"bench", "acquire", "--scenes", "small.btf"}, {"checker_lambert.toml"});
}

TEST_CASE("bench codecs refuses what it cannot measure, before it measures anything") {
  const Mistakes mistakes;
  const auto refused = [&](const std::vector<std::string>& more,
                           const std::vector<std::string>& fragments) {
    std::vector<std::string> arguments = {"bench", "codecs"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    mistakes.refused(arguments, fragments);
  };
  refused({"--codec", "cfm"}, {"'cfm'", "'cmf'", "laplacian"});
  refused({"--codec", "cmf", "--codec", "cmf"}, {"--codec", "'cmf' twice"});
  refused({"--data", "nothing.btf"}, {"nothing.btf"});
  refused({"--data", "fitted.cmf"}, {"fitted.cmf"});
  refused({"--data", "small.btf", "--variant-data", "nothing.btf"}, {"nothing.btf"});
  refused({"--texels", "0"}, {"--texels", "'0'", "from 1 to"});
  refused({"--spp", "0"}, {"--spp", "'0'", "from 1 to"});
  refused({"--directions", "ubo82"}, {"ubo82", "ubo81"});
  refused({"--data", "small.btf", "--variant-directions", "regular:0x8"}, {"regular:0x8"});
  refused({"--mesostructure", "unknown.toml"}, {"unknown.toml:2", "hight"});
  refused({"--scenes", "nothing"}, {"nothing", "folder"});
  refused({"--data", "small.btf", "--codec", "ptm", "--scenes", "nothing"}, {"nothing", "folder"});
  refused({"--comparison-texels", "0"}, {"--comparison-texels", "'0'", "from 1 to"});
  refused({"--comparison-spp", "0"}, {"--comparison-spp", "'0'", "from 1 to"});
}
