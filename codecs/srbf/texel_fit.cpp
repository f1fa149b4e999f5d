#include "codecs/srbf/texel_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "codecs/srbf/initial_guess.h"

namespace weft::srbf {

namespace {

constexpr std::size_t most_peaks = 6;
constexpr float peak_bandwidth = 80;

// Of the largest, in `units`.
constexpr double least_unit = 0.2;

bool is_finite(const TexelFit& fit) {
  return std::isfinite(fit.value.total) &&
         std::ranges::all_of(fit.kernels.values(), [](double v) { return std::isfinite(v); });
}

Direction direction_at(const std::vector<float> (&axes)[3], std::size_t i) {  // NOLINT
  return {axes[0][i], axes[1][i], axes[2][i]};
}

}  // namespace

TexelFitter::TexelFitter(const Samples& samples, const Modes& modes, std::size_t kernels)
    : samples_(samples),
      modes_(modes),
      shape_{kernels, modes.angles.size()},
      objective_(samples, shape_, Ridge{}) {}

void TexelFitter::set_texel(std::span<const float> channels) {
  channels_ = channels;
  objective_.set_texel(channels);
}

TexelFit TexelFitter::as_it_is(Kernels kernels) {
  TexelFit fit{.kernels = std::move(kernels), .value = {}};
  fit.value = objective_(fit.kernels, {}, modes_.free);
  return fit;
}

// How much the error feels each unknown, roughly: the diagonal of Gauss and Newton's matrix with
// each kernel alone. A centre moves over the sphere by its change over lambda, and the Gaussian
// changes over 1 / sqrt(lambda); angles move all centres. Divided by these, L-BFGS needs a third of
// the iterations (docs/codecs/srbf.md).
std::vector<double> TexelFitter::units(const Kernels& kernels) const {
  const std::vector<double> squares = objective_.gaussian_squares();
  std::vector<double> height(shape_.kernels);
  for (std::size_t j = 0; j < shape_.kernels; ++j) {
    double square = 0;
    for (std::size_t c = 0; c < 3; ++c) square += std::pow(kernels.colours()[3 * j + c], 2);
    height[j] = std::sqrt(square * squares[j]);
  }
  const double highest = *std::ranges::max_element(height);
  std::vector<double> units(shape_.unknowns(), 1.0);
  std::vector<double> angle_squares(shape_.modes);
  for (std::size_t j = 0; j < shape_.kernels; ++j) {
    const double weight =
        highest > 0 ? std::max(height[j] / highest, least_unit) : 1.0;  // idle kernels may move too
    for (std::size_t k = 0; k < shape_.modes; ++k) {
      const double* p = kernels.centre(j, k);
      const double lambda = smooth_length(p[0], p[1], p[2]);
      angle_squares[k] += weight * weight * (1 + lambda);
      std::fill_n(&units[3 * (j * shape_.modes + k)], 3, weight / std::sqrt(1 + lambda));
    }
  }
  for (std::size_t k = 0; k < shape_.modes; ++k)
    units[shape_.centres() + k] = std::sqrt(angle_squares[k]);
  return units;
}

TexelFit TexelFitter::descend(const TexelFit& start, const DescentLimits& limits,
                              bool free_angles) {
  Kernels tried = start.kernels;
  objective_(tried, {}, free_angles);
  const std::vector<double> unit = units(tried);
  const std::size_t n = unit.size();
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = tried.unknowns()[i] * unit[i];
  const auto set_unknowns = [&](std::span<const double> at) {
    for (std::size_t i = 0; i < n; ++i) tried.unknowns()[i] = at[i] / unit[i];
  };
  const auto value = [&](std::span<const double> at, std::span<double> gradient) {
    set_unknowns(at);
    const double total = objective_(tried, gradient, free_angles).total;
    for (std::size_t i = 0; i < n; ++i) gradient[i] /= unit[i];
    return total;
  };
  const bool ended = minimise(x, value, limits);
  set_unknowns(x);
  TexelFit end = as_it_is(std::move(tried));
  const bool diverged = !ended || !is_finite(end);
  if (diverged || end.value.total > start.value.total) end = safe(start);
  end.fell_back = diverged;
  return end;
}

// Where not even a start has an error that is a number, its kernels stay, with no colours: what
// they sum up to is 0.
TexelFit TexelFitter::safe(TexelFit fit) const {
  if (is_finite(fit)) return fit;
  for (double& number : fit.kernels.values()) number = std::isfinite(number) ? number : 0;
  std::ranges::fill(fit.kernels.colours(), 0.0);
  return fit;
}

TexelFit TexelFitter::descend(const TexelFit& start, const DescentLimits& limits) {
  return descend(start, limits, modes_.free);
}

TexelFit TexelFitter::from_scratch(int starts, const DescentLimits& limits) {
  Kernels constant(shape_);
  std::ranges::copy(modes_.angles, constant.angles().begin());
  TexelFit best = as_it_is(std::move(constant));
  for (int i = 0; i < starts + 1 && !(best.value.total <= limits.enough); ++i) {
    Kernels guess = i < starts ? initial_guess(samples_, channels_, shape_, modes_,
                                               static_cast<std::uint64_t>(i))
                               : guess_of_peaks();
    TexelFit end = descend(as_it_is(std::move(guess)), limits, false);
    if (modes_.free) {
      const bool fell_back = end.fell_back;
      end = descend(end, limits, true);
      end.fell_back = end.fell_back || fell_back;
    }
    if (is_finite(end) && !(best.value.total <= end.value.total)) best = std::move(end);
  }
  if (is_finite(best)) return best;
  best = safe(std::move(best));
  best.fell_back = true;
  return best;
}

// One kernel after the other at the largest error, narrow in those modes that lower it most.
Kernels TexelFitter::guess_of_peaks() {
  Kernels kernels(shape_);
  std::ranges::copy(modes_.angles, kernels.angles().begin());
  objective_(kernels, {}, false);
  for (std::size_t j = 1; j < std::min(shape_.kernels, most_peaks); ++j) {
    const std::size_t peak = largest_error(kernels);
    Kernels best = kernels;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t narrow = 1; narrow < std::size_t{1} << shape_.modes; ++narrow) {
      Kernels tried = kernels;
      for (std::size_t k = 0; k < shape_.modes; ++k) {
        if ((narrow >> k & 1) == 0) continue;
        const Direction p = psi(modes_.angles[k], direction_at(samples_.light, peak),
                                direction_at(samples_.view, peak)) *
                            peak_bandwidth;
        for (int c = 0; c < 3; ++c) tried.centre(j, k)[c] = p[c];
      }
      const double error = objective_(tried, {}, false).data;
      if (!(error < least)) continue;
      least = error;
      best = std::move(tried);
    }
    kernels = std::move(best);
  }
  return kernels;
}

std::size_t TexelFitter::largest_error(const Kernels& kernels) const {
  double largest = -1;
  std::size_t at = 0;
  for (std::size_t i = 0; i < samples_.pairs; ++i) {
    if (samples_.gain[i] == 0) continue;
    const std::array<double, 3> value =
        evaluate(kernels, direction_at(samples_.light, i), direction_at(samples_.view, i));
    double error = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double difference = value[c] * samples_.gain[i] - channels_[c * samples_.count + i];
      error += difference * difference;
    }
    if (error > largest) {
      largest = error;
      at = i;
    }
  }
  return at;
}

}  // namespace weft::srbf
