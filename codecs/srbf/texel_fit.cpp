#include "codecs/srbf/texel_fit.h"

#include <algorithm>
#include <cmath>

#include "codecs/srbf/initial_guess.h"

namespace weft::srbf {

namespace {

constexpr std::size_t most_peaks = 6;
constexpr float peak_bandwidth = 80;

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

TexelFit TexelFitter::descend(const TexelFit& start, const DescentLimits& limits,
                              bool free_angles) {
  Kernels tried = start.kernels;
  std::vector<double> x(tried.unknowns().begin(), tried.unknowns().end());
  const auto value = [&](std::span<const double> at, std::span<double> gradient) {
    std::ranges::copy(at, tried.unknowns().begin());
    return objective_(tried, gradient, free_angles).total;
  };
  const bool ended = minimise(x, value, limits);
  std::ranges::copy(x, tried.unknowns().begin());
  TexelFit end = as_it_is(std::move(tried));
  if (ended && is_finite(end) && !(end.value.total > start.value.total)) return end;
  end = start;
  end.fell_back = true;
  return end;
}

TexelFit TexelFitter::descend(const TexelFit& start, const DescentLimits& limits) {
  return descend(start, limits, modes_.free);
}

TexelFit TexelFitter::from_scratch(int starts, const DescentLimits& limits) {
  Kernels constant(shape_);
  std::ranges::copy(modes_.angles, constant.angles().begin());
  TexelFit best = as_it_is(std::move(constant));
  for (int i = 0; i < starts + 1; ++i) {
    Kernels guess = i < starts ? initial_guess(samples_, channels_, shape_, modes_.angles,
                                               static_cast<std::uint64_t>(i))
                               : guess_of_peaks();
    TexelFit end = descend(as_it_is(std::move(guess)), limits, false);
    if (modes_.free) end = descend(end, limits, true);
    if (is_finite(end) && end.value.total < best.value.total) best = std::move(end);
  }
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
