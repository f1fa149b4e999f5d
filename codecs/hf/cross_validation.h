// lambda by generalised cross validation (Golub, Heath and Wahba 1979), of the error that is seen.
#pragma once

#include <functional>

#include "codecs/hf/log_system.h"

namespace weft::hf {

/// The lambda of those tried (1e-3 to 10, two a decade) that makes
/// error(x) / (1 - trace / samples)^2 least, x being the solution for it. The trace of the
/// influence matrix is Hutchinson's estimate from 48 vectors of signs that are hashes.
///
/// With |M x - log f|^2 as the error this is generalised cross validation itself. That is blind to
/// what is made of x: maps are filtered after exp, rounded, and multiplied.
/// @param log_f  [light][view], of a few texels.
/// @param error  called from several threads.
double cross_validated_lambda(const LogLookup& lookup, int resolution, const DoubleVector& log_f,
                              const std::function<double(const DoubleVector& x)>& error);

}  // namespace weft::hf
