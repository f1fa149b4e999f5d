// Where a fit begins: expectation and maximisation, as if the kernels were a mixture of
// distributions over the samples (paper 001, section 3.3.1).
#pragma once

#include <cstdint>
#include <span>

#include "codecs/srbf/kernels.h"
#include "codecs/srbf/samples.h"

namespace weft::srbf {

/// Narrower kernels than this stay where they are, however bad the place: a start is broad.
constexpr double broadest_start = 4;

/// Centres and bandwidths, lambda <= `broadest_start`, for modes of these angles, or, where
/// `modes.em_angles`, angles too (equation 3.11), from these on; colours are 0. The first kernel is
/// a constant.
/// @param channels  as `channel_arrays`.
/// @param seed      chooses the samples where the kernels' centres start.
Kernels initial_guess(const Samples& samples, std::span<const float> channels, Shape shape,
                      const Modes& modes, std::uint64_t seed);

}  // namespace weft::srbf
