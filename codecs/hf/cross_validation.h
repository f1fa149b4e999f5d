// lambda by generalised cross validation (Golub, Heath and Wahba 1979).
#pragma once

#include "codecs/hf/log_system.h"

namespace weft::hf {

/// The lambda of those tried (1e-3 to 10, two a decade) that makes the sum over lanes of
/// |M x - log f|^2 / (1 - trace / samples)^2 least. The trace of the influence matrix is
/// Hutchinson's estimate from 48 vectors of signs that are hashes.
/// @param log_f  [light][view], of a few texels.
double cross_validated_lambda(const LogLookup& lookup, int resolution, const DoubleVector& log_f);

}  // namespace weft::hf
