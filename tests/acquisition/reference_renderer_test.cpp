// The acquisition against another renderer's pictures of the same meshes.
//
// Eight runs with different seeds give the mean and its standard error at every texel. A pair's
// mean must agree to 0.2 %. Texel by texel, z is the difference over the joint standard error (ours
// from the spread of the runs, theirs as its index states, and a half's rounding); with 7 degrees
// of freedom |z| > 5 happens by chance in 0.16 % of texels, and up to 0.5 % are let pass.
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "acquisition/view_tracer.h"
#include "btf/hemisphere_sampling.h"
#include "images/image_file.h"
#include "tests/acquisition/known_structures.h"

using namespace weft;

namespace {

std::filesystem::path reference_folder() {
  const char* shared = std::getenv("WEFT_SHARED");
  const std::filesystem::path root =
      shared != nullptr ? shared : std::filesystem::path(WEFT_SOURCE_DIR) / "../shared";
  return root / "reference/images";
}

struct Pair {
  std::string file;
  double light_theta, light_phi, view_theta, view_phi;
  int max_bounces;
  double their_error;  // RMS standard error of a texel, the largest of the three channels
};

constexpr int runs = 8;
constexpr int size = 64;

void compare(const Mesostructure& structure, const Pair& pair, int spp) {
  INFO(pair.file);
  const Image reference = read_image(reference_folder() / (pair.file + ".exr"), Encoding::linear);
  REQUIRE(reference.width == size);
  REQUIRE(reference.height == size);
  const Direction light = from_spherical(radians(pair.light_theta), radians(pair.light_phi));
  const Direction view = from_spherical(radians(pair.view_theta), radians(pair.view_phi));
  const std::size_t count = static_cast<std::size_t>(3) * size * size;
  std::vector<double> sum(count), squares(count);
  TraceSettings settings{
      .width = size, .height = size, .spp = spp, .max_bounces = pair.max_bounces, .seed = 7};
  settings.views = 1'000'000;  // enough for a visibility table, though one is traced
  // With the others, which are not compared, the table answers for bounces, too.
  std::vector<Direction> lights{light};
  for (const Direction& other : named_directions("regular:2x8")) lights.push_back(other);
  const ViewTracer tracer(structure, lights, settings);
  for (int run = 0; run < runs; ++run) {
    const TracedView traced = tracer.trace(view, 1000 + run);
    REQUIRE(traced.statistics.missed == 0);
    for (std::size_t i = 0; i < count; ++i) {
      sum[i] += traced.values[i];
      squares[i] += static_cast<double>(traced.values[i]) * traced.values[i];
    }
  }
  Imath::V3d ours(0, 0, 0), theirs(0, 0, 0);
  int outside = 0;
  double z2 = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double mean = sum[i] / runs;
    const double variance =
        std::max(0.0, squares[i] / runs - mean * mean) * runs / (runs - 1) / runs;
    const double expected = reference.values[i];
    ours[static_cast<int>(i % 3)] += mean;
    theirs[static_cast<int>(i % 3)] += expected;
    const double rounding = expected / 2048 / std::sqrt(12.0);
    const double z = (mean - expected) / std::sqrt(variance + pair.their_error * pair.their_error +
                                                   rounding * rounding + 1e-14);
    outside += std::abs(z) > 5 ? 1 : 0;
    z2 += std::min(z * z, 25.0) / static_cast<double>(count);
  }
  for (int c = 0; c < 3; ++c) CHECK(ours[c] / theirs[c] == Approx(1).margin(0.002));
  CHECK(outside < static_cast<int>(0.005 * static_cast<double>(count)));
  CHECK(z2 < 1.6);
}

}  // namespace

TEST_CASE("checker agrees with another renderer", "[heavy]") {
  if (!std::filesystem::exists(reference_folder())) {
    WARN("skipped: " << reference_folder() << " is not there");
    return;
  }
  const Mesostructure structure = test::checker();
  compare(structure, {"checker_Lt30_Lp20_Vt0_Vp0_direct", 30, 20, 0, 0, 0, 5.6e-6}, 128);
  compare(structure, {"checker_Lt30_Lp20_Vt0_Vp0_gi8", 30, 20, 0, 0, 8, 1.6e-4}, 128);
  compare(structure, {"checker_Lt75_Lp10_Vt45_Vp100_direct", 75, 10, 45, 100, 0, 8.8e-6}, 128);
  compare(structure, {"checker_Lt75_Lp10_Vt45_Vp100_gi8", 75, 10, 45, 100, 8, 9.7e-5}, 128);
}

TEST_CASE("rings agree with another renderer", "[heavy]") {
  if (!std::filesystem::exists(reference_folder())) {
    WARN("skipped: " << reference_folder() << " is not there");
    return;
  }
  const Mesostructure structure = test::rings();
  compare(structure, {"rings_Lt45_Lp30_Vt30_Vp250_direct", 45, 30, 30, 250, 0, 2.9e-5}, 128);
  compare(structure, {"rings_Lt45_Lp30_Vt30_Vp250_gi8", 45, 30, 30, 250, 8, 2.1e-4}, 128);
}
