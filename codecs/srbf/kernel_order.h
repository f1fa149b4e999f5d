// Which kernel of one texel stands for which of another: what is compared, pulled and blended
// number by number (paper 001, equations 3.13 and 3.14) must lie in the same order.
#pragma once

#include "codecs/srbf/kernels.h"

namespace weft::srbf {

/// Differences of p, in units of lambda, weigh less than those of colours and angles.
constexpr double centre_metric = 0.01;

/// Weighted sum of squared differences, number by number, as the robust penalty
/// sees them.
double distance(const Kernels& a, const Kernels& b);

/// `kernels` in the order that lies nearest to `reference`: of all J! the one of the least
/// `distance`. The sum that they stand for stays what it is. O(J^3), 20 us for J = 20.
/// @param reference  of the same shape.
Kernels in_order_of(const Kernels& reference, const Kernels& kernels);

}  // namespace weft::srbf
