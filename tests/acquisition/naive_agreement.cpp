#include "tests/acquisition/naive_agreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "acquisition/naive_tracer.h"
#include "acquisition/view_tracer.h"
#include "btf/hemisphere_sampling.h"
#include "btf/random.h"

namespace weft::test {

Agreement agreement(const Mesostructure& mesostructure, int naive_spp, int spp) {
  const auto structure = std::make_shared<const TraceableStructure>(mesostructure);
  TraceSettings settings{.width = 16, .height = 16, .spp = spp, .max_bounces = 4};
  settings.views = 1'000'000;  // enough for a table, though few are traced
  settings.texel_errors = true;
  // The first two are compared; with the others the table answers for bounces, too.
  constexpr std::size_t compared = 2;
  std::vector<Direction> lights = {from_spherical(radians(20.0), 0.4),
                                   from_spherical(radians(70.0), 3.0)};
  for (const Direction& light : named_directions("regular:3x10")) lights.push_back(light);
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
    result.open_bounces += traced.statistics.open_bounces;
    for (std::size_t l = 0; l < compared; ++l) {
      const NaiveEstimate plain =
          trace_pair_naively(*structure, naive, view, lights[l], hash_coordinates(n, l));
      std::array<double, 3> pair_difference{};
      std::array<double, 3> pair_variance{};
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
        pair_difference[i % 3] += difference;
        pair_variance[i % 3] += both;
      }
      for (std::size_t c = 0; c < 3; ++c) {
        result.largest_pair_z = std::max(
            result.largest_pair_z, std::abs(pair_difference[c]) / std::sqrt(pair_variance[c]));
      }
    }
  }
  result.mean_square_z /= static_cast<double>(n);
  result.outside /= static_cast<double>(n);
  result.difference /= sum;
  result.deviation = std::sqrt(3 * variance) / sum;
  return result;
}

}  // namespace weft::test
