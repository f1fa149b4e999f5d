#include "codecs/srbf/initial_guess.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "btf/random.h"
#include "codecs/srbf/angle_expectation.h"

namespace weft::srbf {

namespace {

constexpr int rounds = 12;

struct Point {
  Direction light;
  Direction view;
  double weight = 0;
  std::array<Direction, most_modes> psi{};
};

void set_variables(std::vector<Point>& points, std::span<const double> angles) {
  for (Point& point : points) {
    for (std::size_t k = 0; k < angles.size(); ++k)
      point.psi[k] = psi(angles[k], point.light, point.view);
  }
}

// The data as a density: B, summed over the channels, where it is seen.
std::vector<Point> points_of(const Samples& samples, std::span<const float> channels,
                             std::span<const double> angles) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < samples.pairs; ++i) {
    if (samples.gain[i] == 0) continue;
    double weight = 0;
    for (std::size_t c = 0; c < 3; ++c) weight += channels[c * samples.count + i];
    points.push_back(
        {.light = Direction(samples.light[0][i], samples.light[1][i], samples.light[2][i]),
         .view = Direction(samples.view[0][i], samples.view[1][i], samples.view[2][i]),
         .weight = std::max(weight, 0.0)});
  }
  set_variables(points, angles);
  return points;
}

void set_centre(Kernels& kernels, std::size_t j, std::size_t k, const Direction& p) {
  for (int c = 0; c < 3; ++c) kernels.centre(j, k)[c] = p[c];
}

// Centres at samples drawn in proportion to the data, one of each J-th part of their sum.
void draw_centres(const std::vector<Point>& points, std::uint64_t seed, Kernels& kernels) {
  double sum = 0;
  for (const Point& point : points) sum += point.weight;
  const std::size_t n = kernels.shape().kernels;
  std::size_t at = 0;
  double below = 0;
  for (std::size_t j = 0; j < n; ++j) {
    const double share =
        (static_cast<double>(j) + unit_float(hash_coordinates(seed, j))) / static_cast<double>(n);
    while (at + 1 < points.size() && below + points[at].weight < share * sum)
      below += points[at++].weight;
    for (std::size_t k = 0; k < kernels.shape().modes; ++k)
      set_centre(kernels, j, k, points[at].psi[k]);
  }
}

// lambda of von Mises' and Fisher's distribution whose mean has this length (Banerjee et al.,
// 2005), held at a start's.
double bandwidth(double mean_length) {
  const double r = std::min(mean_length, 0.9999);
  return std::min(r * (3 - r * r) / (1 - r * r), broadest_start);
}

// Of a kernel: what equation 3.10 sums over the samples.
struct Moments {
  std::array<std::array<double, 3>, most_modes> sum{};
  double weight = 0;
  double mass = 0;  // of the kernel itself over the samples
};

// Equation 3.9: `values[j]` = F_j G_j become what the kernels have of the sample, T P_j.
void share_out(const Point& point, std::span<double> values) {
  double total = 0;
  for (const double value : values) total += value;
  for (double& value : values) value = total > 0 ? point.weight * value / total : 0;
}

void add_moments(const Point& point, std::span<const double> shares, std::size_t modes,
                 std::vector<Moments>& moments) {
  for (std::size_t j = 0; j < shares.size(); ++j) {
    moments[j].weight += shares[j];
    for (std::size_t k = 0; k < modes; ++k) {
      for (int c = 0; c < 3; ++c) moments[j].sum[k][c] += shares[j] * point.psi[k][c];
    }
  }
}

// A sample's terms of equation 3.11.
void add_expectations(const Point& point, std::span<const double> shares, const Kernels& kernels,
                      std::span<AngleExpectation> expectations) {
  for (std::size_t k = 0; k < expectations.size(); ++k) {
    double pull[3] = {};  // NOLINT
    for (std::size_t j = 0; j < shares.size(); ++j) {
      for (int c = 0; c < 3; ++c) pull[c] += shares[j] * kernels.centre(j, k)[c];
    }
    expectations[k].add(pull, point.light, point.view);
  }
}

// One round; `height` are the F_j of the mixture. `expectations`, where there are any, become those
// of each mode's angle, with the centres as they were.
void improve(const std::vector<Point>& points, Kernels& kernels, std::vector<double>& height,
             std::span<AngleExpectation> expectations) {
  const Shape shape = kernels.shape();
  std::vector<Moments> moments(shape.kernels);
  std::vector<double> values(shape.kernels);
  for (const Point& point : points) {
    for (std::size_t j = 0; j < shape.kernels; ++j) {
      double exponent = 0;
      for (std::size_t k = 0; k < shape.modes; ++k) {
        const double* p = kernels.centre(j, k);
        exponent += p[0] * point.psi[k].x + p[1] * point.psi[k].y + p[2] * point.psi[k].z -
                    smooth_length(p[0], p[1], p[2]);
      }
      values[j] = std::exp(exponent);
      moments[j].mass += values[j];
      values[j] *= height[j];
    }
    share_out(point, values);
    add_moments(point, values, shape.modes, moments);
    add_expectations(point, values, kernels, expectations);
  }
  for (std::size_t j = 0; j < shape.kernels; ++j) {
    const Moments& m = moments[j];
    if (!(m.weight > 0) || !(m.mass > 0)) continue;
    height[j] = m.weight / m.mass;
    for (std::size_t k = 0; k < shape.modes; ++k) {
      const Direction mean(static_cast<float>(m.sum[k][0] / m.weight),
                           static_cast<float>(m.sum[k][1] / m.weight),
                           static_cast<float>(m.sum[k][2] / m.weight));
      const float length = mean.length();
      if (length > 0)
        set_centre(kernels, j, k, mean * static_cast<float>(bandwidth(length) / length));
    }
  }
}

// A round that moves the angles, too.
void improve_with_angles(std::vector<Point>& points, Kernels& kernels,
                         std::vector<double>& height) {
  std::vector<AngleExpectation> expectations(kernels.shape().modes);
  improve(points, kernels, height, expectations);
  for (std::size_t k = 0; k < expectations.size(); ++k)
    kernels.angles()[k] = expectations[k].best_near(kernels.angles()[k]);
  set_variables(points, kernels.angles());
}

}  // namespace

Kernels initial_guess(const Samples& samples, std::span<const float> channels, Shape shape,
                      const Modes& modes, std::uint64_t seed) {
  Kernels kernels(shape);
  std::ranges::copy(modes.angles, kernels.angles().begin());
  std::vector<Point> points = points_of(samples, channels, modes.angles);
  if (points.empty()) return kernels;
  draw_centres(points, seed, kernels);
  std::vector<double> height(shape.kernels, 1.0);
  for (int round = 0; round < rounds; ++round) {
    if (modes.em_angles)
      improve_with_angles(points, kernels, height);
    else
      improve(points, kernels, height, {});
  }
  for (std::size_t k = 0; k < shape.modes; ++k) set_centre(kernels, 0, k, Direction(0, 0, 0));
  return kernels;
}

}  // namespace weft::srbf
