// The fast estimator against the plain one: the same means, pair by pair and texel by texel.
#include "acquisition/naive_tracer.h"

#include <cmath>
#include <fstream>
#include <memory>

#include "acquisition/mesostructure.h"
#include "btf/random.h"
#include "tests/temporary_folder.h"

using namespace weft;

namespace {

struct Agreement {
  double mean_square_z =
      0;                  // 1 where the errors are told rightly, less where they are conservative
  double outside = 0;     // share of |z| > 4: chance has 6e-5
  double difference = 0;  // of the means over all, relative
  double deviation = 0;   // standard error of that difference, relative
};

// With a visibility table. Values of one path's channels move together, so the mean's variance is
// taken three times.
Agreement agreement(const Mesostructure& mesostructure, int naive_spp, int spp) {
  const auto structure = std::make_shared<const TraceableStructure>(mesostructure);
  TraceSettings settings{.width = 16, .height = 16, .spp = spp, .max_bounces = 4};
  settings.views = 1'000'000;  // enough for a table, though few are traced
  settings.texel_errors = true;
  const std::vector<Direction> lights = {from_spherical(radians(20.0), 0.4),
                                         from_spherical(radians(70.0), 3.0)};
  const ViewTracer tracer(structure, lights, settings);
  TraceSettings naive = settings;
  naive.spp = naive_spp;
  naive.seed = 7;
  Agreement result;
  double sum = 0;
  double variance = 0;
  std::size_t n = 0;
  for (const double theta : {0.0, 35.0, 75.0}) {
    const Direction view = from_spherical(radians(theta), 1.1F);
    const TracedView traced = tracer.trace(view, n);
    for (std::size_t l = 0; l < lights.size(); ++l) {
      const NaiveEstimate plain =
          trace_pair_naively(*structure, naive, view, lights[l], hash_coordinates(n, l));
      for (std::size_t i = 0; i < plain.values.size(); ++i, ++n) {
        const std::size_t j = l * plain.values.size() + i;
        const double error = traced.texel_errors[j];
        const double rounding = 1e-6 * plain.values[i];  // of the floats, where all samples are one
        const double both = plain.variances[i] + error * error + rounding * rounding + 1e-20;
        const double difference = traced.values[j] - plain.values[i];
        result.mean_square_z += difference * difference / both;
        result.outside += difference * difference > 16 * both ? 1 : 0;
        result.difference += difference;
        variance += both;
        sum += plain.values[i];
      }
    }
  }
  result.mean_square_z /= static_cast<double>(n);
  result.outside /= static_cast<double>(n);
  result.difference /= sum;
  result.deviation = std::sqrt(3 * variance) / sum;
  return result;
}

}  // namespace

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
              << a.difference << " +- " << a.deviation);
    // Glossy values of few samples have tails that a normal distribution does not.
    CHECK(a.mean_square_z < 1.3);
    CHECK(a.outside < 4e-3);
    CHECK(std::abs(a.difference) < 4 * a.deviation);
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
  const Agreement a = agreement(read_mesostructure(folder.path / "wire.toml"), 2048, 512);
  INFO("mean z^2 " << a.mean_square_z << ", difference " << a.difference << " +- " << a.deviation);
  CHECK(a.mean_square_z < 1.3);
  CHECK(a.outside < 4e-3);
  CHECK(std::abs(a.difference) < 4 * a.deviation);
}
