// A disk that fills up: exit 1, what is finished stays, nothing half written does, and a rerun
// continues.

#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/temporary_folder.h"

using Catch::Matchers::Contains;

namespace {

/// Runs `script` where `disk` is a small disk of its own, in a namespace that is gone afterwards;
/// "$0" is weft.
Outcome on_small_disk(const TemporaryFolder& folder, const std::string& size,
                      const std::string& script) {
  const std::string mount = "mkdir -p disk && mount -t tmpfs -o size=" + size + " none disk && ";
  return run_program(
      {"unshare", "--map-root-user", "--mount", "sh", "-c", mount + script, WEFT_BINARY},
      folder.path);
}

bool has_namespaces(const TemporaryFolder& folder) {
  return on_small_disk(folder, "64k", "true").exit_code == 0;
}

}  // namespace

TEST_CASE("A full disk ends an acquisition with 1, keeps whole views, and a rerun continues") {
  const TemporaryFolder folder;
  if (!has_namespaces(folder)) {
    WARN("skipped: this machine lets nobody mount a small disk");
    return;
  }
  std::ofstream(folder.path / "checker.toml") << "type = \"checker\"\nresolution = 16\n";
  const std::string acquire =
      "\"$0\" acquire checker.toml -o disk/out.btf --texels 16 --directions regular:3x6 --spp 1 "
      "--json";
  const Outcome outcome = on_small_disk(
      folder, "200k",
      acquire +
          " 2>error; echo $? >code; ls -A disk/out.btf >kept; mount -o remount,size=20m disk && " +
          acquire);
  const auto text = [&](const char* name) {
    std::ifstream in(folder.path / name);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  INFO(text("error") << text("kept"));
  CHECK(text("code") == "1\n");
  CHECK_THAT(text("error"), Contains("disk/out.btf") && Contains("No space left"));
  CHECK_THAT(text("kept"), Contains("view_000.exr") && !Contains(".part") && !Contains("btf.json"));

  CHECK(outcome.exit_code == 0);
  const auto told = nlohmann::json::parse(outcome.out, nullptr, false);
  REQUIRE(told.is_object());
  CHECK(told["views_kept"].get<int>() > 0);
  CHECK(told["views_kept"].get<int>() < 18);
}

TEST_CASE("A full disk ends compress and extract with 1 and leaves nothing") {
  const TemporaryFolder folder;
  if (!has_namespaces(folder)) {
    WARN("skipped: this machine lets nobody mount a small disk");
    return;
  }
  std::ofstream(folder.path / "checker.toml") << "type = \"checker\"\nresolution = 16\n";
  REQUIRE(run_weft({"acquire", "checker.toml", "-o", "in.btf", "--texels", "16", "--directions",
                    "regular:3x6", "--spp", "1"},
                   folder.path)
              .exit_code == 0);
  for (const std::string& command :
       {std::string("compress in.btf --codec cmf -o disk/out.cmf --set bits=float"),
        std::string("extract in.btf --view 0,0 --light 0,0 --size 512x512 -o disk/a.exr")}) {
    const Outcome outcome = on_small_disk(
        folder, "16k", "\"$0\" " + command + "; code=$?; find disk -mindepth 1 >left; exit $code");
    INFO(command << ": " << outcome.err);
    CHECK(outcome.exit_code == 1);
    CHECK_THAT(outcome.err, Contains("disk/"));
    CHECK(std::filesystem::file_size(folder.path / "left") == 0);
  }
}
