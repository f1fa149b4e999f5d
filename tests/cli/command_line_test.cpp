// The command line itself: help, names that do not exist, JSON.

#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/cli/small_dataset.h"
#include "tests/temporary_folder.h"

using Catch::Matchers::Contains;

namespace {

const std::vector<std::string> subcommands = {"acquire",  "compress", "render", "preview",
                                              "extract",  "compare",  "info",   "list",
                                              "validate", "demo"};

}  // namespace

TEST_CASE("The program's help names every subcommand, and each has its own") {
  const TemporaryFolder folder;
  const Outcome all = run_weft({"--help"}, folder.path);
  CHECK(all.exit_code == 0);
  for (const std::string& name : subcommands) {
    INFO(name);
    CHECK_THAT(all.out, Contains(name));
    const Outcome one = run_weft({name, "--help"}, folder.path);
    CHECK(one.exit_code == 0);
    CHECK_THAT(one.out, Contains("Usage:") && Contains(name) && Contains("--help"));
    for (const char* option : {"--json", "--quiet", "--threads", "--seed"}) {
      CHECK_THAT(one.out, Contains(option));
    }
  }
}

TEST_CASE("A subcommand that does not exist is answered with those that do") {
  const TemporaryFolder folder;
  const Outcome mistyped = run_weft({"extrakt"}, folder.path);
  CHECK_THAT(mistyped.err, Contains("extrakt"));
  const Outcome missing = run_weft({}, folder.path);
  for (const Outcome& outcome : {mistyped, missing}) {
    CHECK(outcome.exit_code == 2);
    for (const std::string& name : subcommands) CHECK_THAT(outcome.err, Contains(name));
  }
}

TEST_CASE("A mistyped word below a subcommand is named, with the valid ones") {
  const TemporaryFolder folder;
  const Outcome mistyped = run_weft({"list", "codcs"}, folder.path);
  const Outcome missing = run_weft({"list"}, folder.path);
  CHECK_THAT(mistyped.err, Contains("'codcs'") && Contains("did you mean 'codecs'"));
  for (const Outcome& outcome : {mistyped, missing}) {
    CHECK(outcome.exit_code == 2);
    for (const char* name : {"codecs", "mesostructures", "scenes"}) {
      CHECK_THAT(outcome.err, Contains(name));
    }
    CHECK_THAT(outcome.err, !Contains("acquire"));
  }
}

TEST_CASE("Values out of range are refused in a short sentence that names them") {
  const TemporaryFolder folder;
  const auto [arguments, found] = GENERATE(table<std::vector<std::string>, std::string>({
      {{"list", "codecs", "--seed", "-1"}, "--seed: found '-1'"},
      {{"list", "codecs", "--seed", "1.5"}, "--seed: found '1.5'"},
      {{"list", "codecs", "--threads", "-1"}, "--threads: found '-1'"},
      {{"compare", "a.exr", "b.exr", "--max-rmse", "abc"}, "--max-rmse: found 'abc'"},
      {{"compare", "a.exr", "b.exr", "--map-top", "0"}, "--map-top: found '0'"},
      {{"extract", "a", "-o", "a.exr", "--view", "0,0", "--light", "0,0", "--scale", "0"},
       "--scale: found '0'"},
      {{"render", "a.toml", "-o", "a.exr", "--integrator", "dirct"}, "did you mean 'direct'"},
  }));
  const Outcome outcome = run_weft(arguments, folder.path);
  CHECK(outcome.exit_code == 2);
  CHECK_THAT(outcome.err, Contains(found));
  CHECK(outcome.err.size() < 160);
}

TEST_CASE("With --json a command prints one JSON object and nothing else") {
  const TemporaryFolder folder;
  write_small_dataset(folder.path / "small.btf");
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"info", "small.btf", "--json"},
           {"validate", "small.btf", "--json"},
           {"list", "codecs", "--json"},
           {"list", "mesostructures", "--json"},
           {"extract", "small.btf", "--view", "0,0", "--light", "30,40", "-o", "a.exr", "--json"},
           {"compress", "small.btf", "--codec", "cmf", "-o", "small.cmf", "--json"},
           {"info", "small.cmf", "--json"}}) {
    INFO(arguments[0] << " " << arguments[1]);
    const Outcome outcome = run_weft(arguments, folder.path);
    CHECK(outcome.exit_code == 0);
    CHECK(outcome.err.empty());
    CHECK(nlohmann::json::parse(outcome.out, nullptr, false).is_object());
  }
}

TEST_CASE("With --quiet a command prints nothing") {
  const TemporaryFolder folder;
  write_small_dataset(folder.path / "small.btf");
  const Outcome outcome = run_weft({"info", "small.btf", "--quiet"}, folder.path);
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.out.empty());
  CHECK(outcome.err.empty());
}

// `script` gives the program a terminal.
TEST_CASE("acquire shows progress, views and rays a second on a terminal, and nothing in a pipe") {
  const TemporaryFolder folder;
  std::ofstream(folder.path / "checker.toml")
      << "type = \"checker\"\n[materials.low]\ntype = \"lambert\"\nalbedo = [0.2, 0.3, 0.4]\n"
         "[materials.raised]\ntype = \"lambert\"\nalbedo = [0.5, 0.4, 0.3]\n";
  const std::string arguments = "acquire checker.toml -o checker.btf --texels 32 --spp 4";
  const Outcome shown = run_program(
      {"script", "-qec", std::string(WEFT_BINARY) + " " + arguments, "/dev/null"}, folder.path);
  CHECK(shown.exit_code == 0);
  CHECK_THAT(shown.out, Contains("acquire") && Contains(" %") && Contains(" views/s") &&
                            Contains(" rays/s") && Contains(" s left"));
  const Outcome piped = run_weft({"acquire", "checker.toml", "-o", "again.btf", "--texels", "8",
                                  "--spp", "1", "--directions", "regular:2x4"},
                                 folder.path);
  CHECK(piped.exit_code == 0);
  CHECK(piped.err.empty());
}
