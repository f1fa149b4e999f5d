// The mesostructures that are random height fields: leather and corduroy without their randomness
// are known surfaces, and their keys do what they say.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "acquisition/mesostructure.h"
#include "btf/error.h"
#include "tests/acquisition/mesostructure_files.h"

using namespace weft;
using Catch::Matchers::Contains;

namespace {

/// The height at the vertex nearest to a place.
class Heights {
 public:
  explicit Heights(const std::string& name, const std::vector<std::string>& overrides)
      : mesh_(read_mesostructure(mesostructure_folder() / (name + ".toml"), overrides).mesh),
        size_(static_cast<int>(std::lround(std::sqrt(mesh_.positions.size()))) - 1) {}

  double at(double x, double y) const {
    const auto i = static_cast<std::size_t>(std::lround(x * size_));
    const auto j = static_cast<std::size_t>(std::lround(y * size_));
    return mesh_.positions[j * (size_ + 1) + i].z;
  }
  const TriangleMesh& mesh() const { return mesh_; }

 private:
  TriangleMesh mesh_;
  int size_;
};

}  // namespace

TEST_CASE("regular leather is rows of pebbles whose creases lie at height 0") {
  const Heights z("leather", {"pebbles=8", "irregularity=0", "bend=0", "wrinkles=0", "height=0.04",
                              "crease=0.1", "resolution=320"});
  for (int k = 0; k < 8; ++k) {
    CHECK(z.at(k / 8.0, 0.3) == Approx(0).margin(1e-7));
    CHECK(z.at(0.7, k / 8.0) == Approx(0).margin(1e-7));
    // Each pebble has a height of its own, from 3/4 on in its wide part.
    CHECK(z.at((k + 0.5) / 8, 0.4375) > 0.75 * 0.04);
    CHECK(z.at((k + 0.5) / 8, 0.4375) < 0.04);
  }
  // One crease width inside the border the narrow part is 1 - 1/e of its half.
  CHECK(z.at(0.5 + 0.1 / 8, 0.4375) > 0.5 * 0.04 * (1 - std::exp(-1.0)));
}

TEST_CASE("corduroy without tufts has wales of half an ellipse") {
  const Heights z("corduroy", {"wales=4", "height=0.5", "width=0.8", "wobble=0", "tuft_depth=0",
                               "fuzz=0", "resolution=320"});
  for (int k = 0; k < 4; ++k) {
    CHECK(z.at((k + 0.5) / 4, 0.6) == Approx(0.5 / 4).epsilon(0.01));
    // The middle between the wale's axis and its edge.
    CHECK(z.at((k + 0.7) / 4, 0.1) == Approx(0.5 / 4 * std::sqrt(0.75)).epsilon(0.01));
    CHECK(z.at(k / 4.0, 0.3) < 0.2 * 0.5 / 4);
    CHECK(z.at((k + 0.3) / 4, 0.1) == z.at((k + 0.3) / 4, 0.9));
  }
  const TriangleMesh& mesh = z.mesh();
  double pile = 0;
  for (const std::uint16_t m : mesh.materials) pile += mesh.material_names[m] == "pile";
  CHECK(pile / static_cast<double>(mesh.materials.size()) == Approx(0.8).margin(0.02));
}

TEST_CASE("tufts and fuzz make the pile uneven, and wobble bends its edges") {
  const auto unevenness = [](const std::vector<std::string>& overrides) {
    const Heights z("corduroy", overrides);
    double sum = 0;
    for (int j = 0; j < 100; ++j)
      sum += std::abs(z.at(0.5, j / 100.0) - z.at(0.5, j / 100.0 + 0.01));
    return sum;
  };
  const std::string none[] = {"tuft_depth=0", "fuzz=0", "wobble=0"};
  CHECK(unevenness({none[0], none[1], none[2]}) == 0);
  for (int k = 0; k < 3; ++k) {
    INFO("all but " << none[k]);
    CHECK(unevenness({none[(k + 1) % 3], none[(k + 2) % 3]}) > 0);
  }
}

TEST_CASE("a seed makes another random relief, the same one each time") {
  for (const char* name : {"leather", "corduroy"}) {
    INFO(name);
    const auto positions = [&](const std::string& seed) {
      return read_mesostructure(mesostructure_folder() / (std::string(name) + ".toml"),
                                {"resolution=64", "seed=" + seed})
          .mesh.positions;
    };
    CHECK(positions("7") == positions("7"));
    CHECK(positions("7") != positions("8"));
    CHECK_THROWS_WITH(positions("-1"), Contains("'seed' is -1, expected 0 to 1000000"));
  }
}
