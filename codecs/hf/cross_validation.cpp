#include "codecs/hf/cross_validation.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "btf/random.h"

namespace weft::hf {

using factor_maps::lane_count;

namespace {

// 0.001 to 1000, where the least is found within on whatever was tried.
constexpr int candidates = 13;

double candidate(int i) {
  return std::pow(10.0, -3.0 + 0.5 * i);
}

DoubleVector signs(std::size_t pairs) {
  DoubleVector result(pairs);
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    for (int k = 0; k < lane_count; ++k)
      result[pair][k] = (hash_coordinates(pair, k) >> 63) != 0 ? 1.0 : -1.0;
  }
  return result;
}

// A^-1 M^T f / samples.
DoubleVector solution(const LogLookup& lookup, const LogSystem& system, const DoubleVector& f) {
  DoubleVector right = lookup.transposed_times(f);
  const double weight = 1.0 / static_cast<double>(lookup.pairs());
  for (auto& value : right) {
    for (int k = 0; k < lane_count; ++k) value[k] *= weight;
  }
  return system.solve(right);
}

// The trace as a share of the samples.
double trace_share(const DoubleVector& probes, const DoubleVector& answers) {
  double sum = 0;
  for (std::size_t pair = 0; pair < probes.size(); ++pair) {
    for (int k = 0; k < lane_count; ++k) sum += probes[pair][k] * answers[pair][k];
  }
  return sum / (static_cast<double>(probes.size()) * lane_count);
}

}  // namespace

double cross_validated_lambda(const LogLookup& lookup, int resolution, const DoubleVector& log_f,
                              const std::function<double(const DoubleVector& x)>& error) {
  const DoubleVector probes = signs(lookup.pairs());
  std::array<double, candidates> score{};
  tbb::parallel_for(0, candidates, [&](int i) {
    const LogSystem system(lookup, resolution, candidate(i));
    const double left = 1 - trace_share(probes, lookup.times(solution(lookup, system, probes)));
    score[i] = error(solution(lookup, system, log_f)) / (left * left);
  });
  return candidate(static_cast<int>(std::ranges::min_element(score) - score.begin()));
}

}  // namespace weft::hf
