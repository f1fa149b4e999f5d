#include "codecs/srbf/initial_guess.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "btf/random.h"

namespace weft::srbf {

namespace {

constexpr int rounds = 12;

struct Point {
  std::array<Direction, most_modes> psi;
  double weight;
};

// The data as a density: B, summed over the channels, where it is seen.
std::vector<Point> points_of(const Samples& samples, std::span<const float> channels,
                             std::span<const double> angles) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < samples.pairs; ++i) {
    if (samples.gain[i] == 0) continue;
    double weight = 0;
    for (std::size_t c = 0; c < 3; ++c) weight += channels[c * samples.count + i];
    Point point{.psi = {}, .weight = std::max(weight, 0.0)};
    const Direction light(samples.light[0][i], samples.light[1][i], samples.light[2][i]);
    const Direction view(samples.view[0][i], samples.view[1][i], samples.view[2][i]);
    for (std::size_t k = 0; k < angles.size(); ++k) point.psi[k] = psi(angles[k], light, view);
    points.push_back(point);
  }
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

// Equation 3.9: shares of a sample, `values[j]` = F_j G_j.
void share_out(const Point& point, std::span<const double> values, std::vector<Moments>& moments,
               std::size_t modes) {
  double total = 0;
  for (const double value : values) total += value;
  if (!(total > 0)) return;
  for (std::size_t j = 0; j < values.size(); ++j) {
    const double weight = point.weight * values[j] / total;
    moments[j].weight += weight;
    for (std::size_t k = 0; k < modes; ++k) {
      for (int c = 0; c < 3; ++c) moments[j].sum[k][c] += weight * point.psi[k][c];
    }
  }
}

// One round; `height` are the F_j of the mixture. The angles stay: equation 3.11 would turn every
// mode to the half-way vector, where psi varies least (docs/codecs/srbf.md).
void improve(const std::vector<Point>& points, Kernels& kernels, std::vector<double>& height) {
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
    share_out(point, values, moments, shape.modes);
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

}  // namespace

Kernels initial_guess(const Samples& samples, std::span<const float> channels, Shape shape,
                      std::span<const double> angles, std::uint64_t seed) {
  Kernels kernels(shape);
  std::ranges::copy(angles, kernels.angles().begin());
  const std::vector<Point> points = points_of(samples, channels, angles);
  if (points.empty()) return kernels;
  draw_centres(points, seed, kernels);
  std::vector<double> height(shape.kernels, 1.0);
  for (int round = 0; round < rounds; ++round) improve(points, kernels, height);
  for (std::size_t k = 0; k < shape.modes; ++k) set_centre(kernels, 0, k, Direction(0, 0, 0));
  return kernels;
}

}  // namespace weft::srbf
