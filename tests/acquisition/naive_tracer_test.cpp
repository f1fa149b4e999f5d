// The fast estimator against the plain one: the same means, pair by pair and texel by texel.
#include <cmath>
#include <fstream>

#include "acquisition/mesostructure.h"
#include "tests/acquisition/naive_agreement.h"
#include "tests/temporary_folder.h"

using namespace weft;
using test::Agreement;
using test::agreement;

TEST_CASE("the fast estimator has the plain one's means", "[heavy]") {
  const std::string scenes = std::string(WEFT_SOURCE_DIR) + "/scenes/mesostructures/";
  for (const auto& [file, overrides] :
       std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"checker_lambert.toml", {"resolution=48"}},
           {"checker.toml", {"resolution=48"}},
           {"rings.toml", {"segments=48", "minor_segments=12"}},
           {"tissue.toml", {}},
           {"knit.toml", {"stitches=[1, 1]", "yarn.radius=0.12", "yarn.fibres=3"}}}) {
    const Agreement a = agreement(read_mesostructure(scenes + file, overrides), 512, 128);
    INFO(file << ": mean z^2 " << a.mean_square_z << ", outside " << a.outside << ", difference "
              << a.difference << " +- " << a.deviation << ", largest of a pair's mean "
              << a.largest_pair_z);
    // Glossy values of few samples have tails that a normal distribution does not.
    CHECK(a.mean_square_z < 1.3);
    CHECK(a.outside < 4e-3);
    CHECK(std::abs(a.difference) < 4 * a.deviation);
    // 18 pairs and channels of each of five structures: by chance once in 1,700 seeds.
    CHECK(a.largest_pair_z < 4.5);
    CHECK(a.open_bounces > 0);
  }
}

TEST_CASE("a wire thinner than the table's cells keeps its shadow") {
  const TemporaryFolder folder;
  std::ofstream(folder.path / "wire.obj")
      << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
         "v 0.5004 0 0.1\nv 0.5026 0 0.1\nv 0.5026 1 0.1\nv 0.5004 1 0.1\nf 5 6 7 8\n";
  std::ofstream(folder.path / "wire.toml")
      << "type = \"mesh\"\nfile = \"wire.obj\"\nreference_height = 0.1\n[materials.default]\n"
         "type = \"lambert\"\nalbedo = [0.8, 0.8, 0.8]\n";
  // So many samples that each texel has some of the few checks that find the wire.
  const Agreement a = agreement(read_mesostructure(folder.path / "wire.toml"), 2048, 2048);
  INFO("mean z^2 " << a.mean_square_z << ", difference " << a.difference << " +- " << a.deviation);
  CHECK(a.mean_square_z < 1.3);
  CHECK(a.outside < 4e-3);
  CHECK(std::abs(a.difference) < 4 * a.deviation);
}
