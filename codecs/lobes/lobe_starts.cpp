#include "codecs/lobes/lobe_starts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace weft::lobes {

namespace {

constexpr double broad = 1;
constexpr double middling = 6;
constexpr double narrow = 40;

Lobe lobe_at(const LightTable& lights, std::size_t light, double exponent) {
  return {lights.direction(light), 0, exponent};
}

std::vector<double> residual_of(const LightTable& lights, std::span<const double> values,
                                const LobeSum& lobes) {
  std::vector<double> residual(lights.padded());
  evaluate(lights, lobes, residual);
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = values[i] - residual[i];
  return residual;
}

std::size_t largest_light(const LightTable& lights, std::span<const double> values) {
  return static_cast<std::size_t>(
      std::max_element(values.begin(),
                       values.begin() + static_cast<std::ptrdiff_t>(lights.size())) -
      values.begin());
}

}  // namespace

std::vector<double> high_pass(const LightTable& lights, std::span<const double> values) {
  std::vector<double> response(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const auto around = lights.neighbours(i);
    double mean = 0;
    for (const std::size_t j : around) mean += values[j] / static_cast<double>(around.size());
    response[i] = values[i] - mean;
  }
  return response;
}

std::vector<std::size_t> principal_lights(const LightTable& lights, std::span<const double> values,
                                          std::size_t count) {
  const std::vector<double> response = high_pass(lights, values);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const auto is_larger = [&](std::size_t j) {
      return response[j] > response[i] || (response[j] == response[i] && j < i);
    };
    if (response[i] > 0 && std::ranges::none_of(lights.neighbours(i), is_larger))
      found.push_back(i);
  }
  std::ranges::stable_sort(found, std::greater{}, [&](std::size_t i) { return response[i]; });
  if (found.size() > count) found.resize(count);
  return found;
}

LobeSum cosine_lobe(const LightTable& lights, std::span<const double> values, int count) {
  LobeSum sum;
  fit_peaks(lights, values, sum);
  sum.count = count;
  return sum;
}

LobeSum mean_lobe(const LightTable& lights, std::span<const double> values) {
  LobeSum sum;
  std::array<double, 3> mean{0, 0, 1e-9};
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const auto direction = lights.direction(i);
    for (int c = 0; c < 3; ++c) mean[c] += values[i] * direction[c];
  }
  const double length = std::hypot(mean[0], mean[1], mean[2]);
  for (int c = 0; c < 3; ++c) sum.lobe[0].axis[c] = mean[c] / length;
  sum.lobe[0].exponent = broad;
  fit_peaks(lights, values, sum);
  return sum;
}

std::vector<LobeSum> starts(const LightTable& lights, std::span<const double> values, int count,
                            const FitLimits& limits) {
  std::vector<LobeSum> all;
  LobeSum one = mean_lobe(lights, values);
  improve(lights, values, limits, one);
  if (count == 1) all.push_back(one);

  std::vector<std::size_t> principal =
      principal_lights(lights, values, static_cast<std::size_t>(count));
  if (principal.empty()) principal.push_back(largest_light(lights, values));
  const auto principal_lobe = [&](int k, double exponent) {
    return lobe_at(lights, principal[static_cast<std::size_t>(k) % principal.size()], exponent);
  };
  LobeSum at_principal;  // the paper's
  LobeSum beside_mean = mean_lobe(lights, values);
  for (int k = 0; k < count; ++k) {
    at_principal.lobe[k] =
        principal_lobe(k, k < static_cast<int>(principal.size()) ? middling : broad);
    if (k > 0) beside_mean.lobe[k] = principal_lobe(k - 1, narrow);
  }
  LobeSum one_by_one = one;
  for (int k = 1; k < count; ++k) {
    const std::vector<double> left = residual_of(lights, values, one_by_one);
    one_by_one.lobe[k] = lobe_at(lights, largest_light(lights, left), middling);
    one_by_one.count = k + 1;
    fit_peaks(lights, values, one_by_one);
    if (k + 1 < count) improve(lights, values, limits, one_by_one);
  }
  for (LobeSum* sum : {&at_principal, &beside_mean, &one_by_one}) {
    sum->count = count;
    fit_peaks(lights, values, *sum);
    all.push_back(*sum);
  }
  return all;
}

}  // namespace weft::lobes
