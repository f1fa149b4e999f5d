#include "study/pair_errors.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "btf/error.h"
#include "codecs/laplacian/colour.h"

namespace weft {

namespace {

struct Sums {
  std::array<double, 3> square{};
  std::array<double, 3> absolute{};
};

bool is_above(const Direction& direction) {
  return direction.z > 0;
}

void add(const Rgb& answer, const Rgb& wanted, Sums& sums) {
  for (std::size_t c = 0; c < 3; ++c) {
    double difference = 0;
    for (int i = 0; i < 3; ++i) {
      difference += laplacian::ycbcr_of_rgb[c][i] * (static_cast<double>(answer[i]) - wanted[i]);
    }
    sums.square[c] += difference * difference;
    sums.absolute[c] += std::abs(difference);
  }
}

// Sums over the texels, one a light.
std::vector<Sums> view_sums(const Btf& reference, const Representation& test, std::size_t view) {
  const std::span<const Direction> lights = reference.lights().directions();
  std::vector<Sums> sums(lights.size());
  std::vector<AppearanceQuery> queries(lights.size());
  std::vector<Rgb> answers(lights.size());
  for (int y = 0; y < reference.height(); ++y) {
    for (int x = 0; x < reference.width(); ++x) {
      const Texcoord uv(
          (static_cast<float>(x) + 0.5F) / static_cast<float>(reference.width()),
          1 - (static_cast<float>(y) + 0.5F) / static_cast<float>(reference.height()));
      for (std::size_t l = 0; l < lights.size(); ++l)
        queries[l] = {uv, lights[l], reference.views()[view], 0};
      test.evaluate(queries, answers);
      for (std::size_t l = 0; l < lights.size(); ++l)
        add(answers[l], reference.at(l, view, x, y), sums[l]);
    }
  }
  return sums;
}

PairSpread spread_of(const std::vector<double>& values) {
  PairSpread spread;
  if (values.empty()) return spread;
  for (const double value : values) spread.average += value;
  spread.average /= static_cast<double>(values.size());
  const auto [least, greatest] = std::ranges::minmax(values);
  spread.least = least;
  spread.greatest = greatest;
  return spread;
}

}  // namespace

PairErrors pair_errors(const Btf& reference, const Representation& test,
                       const std::string& test_name) {
  if (test.texels() != Imath::V2i(reference.width(), reference.height())) {
    throw bad_input(
        test_name, fmt::format("has {} x {} texels, but the reference has {} x {}", test.texels().x,
                               test.texels().y, reference.width(), reference.height()));
  }
  std::vector<std::vector<Sums>> views(reference.views().size());
  tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t v) {
    if (is_above(reference.views()[v])) views[v] = view_sums(reference, test, v);
  });
  const double texels = static_cast<double>(reference.width()) * reference.height();
  PairErrors errors;
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<double> squares;
    std::vector<double> absolutes;
    for (const std::vector<Sums>& lights : views) {
      for (std::size_t l = 0; l < lights.size(); ++l) {
        if (!is_above(reference.lights()[l])) continue;
        squares.push_back(lights[l].square[c] / texels);
        absolutes.push_back(lights[l].absolute[c] / texels);
      }
    }
    errors.channels[c] = {.mse = spread_of(squares), .mae = spread_of(absolutes)};
    errors.pairs = squares.size();
  }
  return errors;
}

}  // namespace weft
