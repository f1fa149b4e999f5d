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
  for (const auto& entry : std::filesystem::directory_iterator(folder.path / "a.btf")) {
    CHECK(file_checksum(entry.path()) ==
          file_checksum(folder.path / "b.btf" / entry.path().filename()));
  }
}

TEST_CASE("what a killed run left half written is gone after the next") {
  const TemporaryFolder folder;
  run(folder.path / "a.btf", small());
  // The number of a process that cannot be: above Linux's largest.
  std::ofstream(folder.path / "a.btf/.view_002.part99999999.exr") << "half";
  run(folder.path / "a.btf", small());
  CHECK_FALSE(std::filesystem::exists(folder.path / "a.btf/.view_002.part99999999.exr"));
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
