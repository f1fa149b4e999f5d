// Whole acquisitions on disk: continuing, and telling other settings apart.
#include "acquisition/acquire.h"

#include <filesystem>
#include <fstream>

#include "btf/atomic_file.h"
#include "btf/btf_file.h"
#include "tests/acquisition/known_structures.h"
#include "tests/temporary_folder.h"

using namespace weft;

namespace {

AcquisitionSettings small() {
  AcquisitionSettings settings;
  settings.trace = {.width = 6, .height = 5, .spp = 2, .max_bounces = 1, .seed = 3};
  settings.views = "regular:2x3";
  settings.lights = "fibonacci:4";
  return settings;
}

void run(const std::filesystem::path& folder, const AcquisitionSettings& settings) {
  Progress silent;
  acquire(test::checker(16), settings, folder, silent);
}

void expect_same_files(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(a)) {
    const auto other = b / entry.path().filename();
    INFO(other);
    REQUIRE(std::filesystem::exists(other));
    CHECK(file_checksum(entry.path()) == file_checksum(other));
    ++files;
  }
  CHECK(files ==
        static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(b), {})));
}

}  // namespace

TEST_CASE("a continued acquisition has the bytes of one in one go") {
  const TemporaryFolder folder;
  run(folder.path / "a.btf", small());
  run(folder.path / "b.btf", small());
  for (const char* name : {"view_001.exr", "view_004.exr", "btf.json"}) {
    std::filesystem::remove(folder.path / "b.btf" / name);
  }
  Progress silent;
  const AcquisitionReport report =
      acquire(test::checker(16), small(), folder.path / "b.btf", silent);
  CHECK(report.views_kept == 4);
  expect_same_files(folder.path / "a.btf", folder.path / "b.btf");
}

TEST_CASE("shards in any order, and twice, have the bytes of one run in one go") {
  const TemporaryFolder folder;
  run(folder.path / "a.btf", small());
  const auto shards = folder.path / "b.btf";
  Progress silent;
  std::size_t kept = 0;
  for (const std::size_t index : {2, 0, 2, 3}) {
    kept += acquire_shard(test::checker(16), small(), {index, 4}, shards, silent).views_kept;
    CHECK_FALSE(std::filesystem::exists(shards / "btf.json"));
  }
  CHECK(kept == 1);  // shard 2's only view, the second time
  CHECK(finish_acquisition(test::checker(16), small(), shards) == std::vector<std::size_t>{1, 5});
  CHECK_FALSE(std::filesystem::exists(shards / "btf.json"));
  AcquisitionSettings other = small();
  other.trace.seed = 4;
  CHECK_THROWS_WITH(acquire_shard(test::checker(16), other, {1, 4}, shards, silent),
                    Catch::Contains("other settings"));
  CHECK_THROWS_WITH(finish_acquisition(test::checker(16), other, shards),
                    Catch::Contains("other settings"));
  acquire_shard(test::checker(16), small(), {1, 4}, shards, silent);
  CHECK(finish_acquisition(test::checker(16), small(), shards).empty());
  CHECK_THAT(read_text(shards / "btf.json"), Catch::Contains("standard_error_of_pair_means"));
  expect_same_files(folder.path / "a.btf", shards);
}

TEST_CASE("a plain run continues what shards began, and a shard of none has nothing to do") {
  const TemporaryFolder folder;
  run(folder.path / "a.btf", small());
  Progress silent;
  const auto shards = folder.path / "b.btf";
  acquire_shard(test::checker(16), small(), {1, 2}, shards, silent);
  CHECK(acquire(test::checker(16), small(), shards, silent).views_kept == 3);
  expect_same_files(folder.path / "a.btf", shards);
  CHECK(acquire_shard(test::checker(16), small(), {8, 9}, shards, silent).statistics.paths == 0);
  expect_same_files(folder.path / "a.btf", shards);
}

TEST_CASE("views of other settings are not kept") {
  const TemporaryFolder folder;
  run(folder.path / "a.btf", small());
  AcquisitionSettings other = small();
  other.pixel_type = PixelType::float32;
  CHECK_THROWS_WITH(run(folder.path / "a.btf", other), Catch::Contains("other settings"));
  other = small();
  other.trace.spp = 3;
  CHECK_THROWS_WITH(run(folder.path / "a.btf", other), Catch::Contains("other settings"));
}

TEST_CASE("a file of directions is known by its content") {
  const TemporaryFolder folder;
  const std::string name = (folder.path / "d.csv").string();
  AcquisitionSettings settings = small();
  settings.lights = "file:" + name;
  std::ofstream(name) << "theta,phi\n0,0\n40,10\n";
  const std::string first = provenance_of(test::checker(16), settings);
  CHECK(first.find(name) == std::string::npos);
  std::ofstream(name) << "theta,phi\n0,0\n41,10\n";
  CHECK(provenance_of(test::checker(16), settings) != first);
}

TEST_CASE("in memory and on disk are the same") {
  const TemporaryFolder folder;
  run(folder.path / "a.btf", small());
  const Btf disk = read_btf(folder.path / "a.btf");
  const Btf memory = acquire(test::checker(16), small());
  CHECK(std::equal(disk.halfs().begin(), disk.halfs().end(), memory.halfs().begin()));
}
