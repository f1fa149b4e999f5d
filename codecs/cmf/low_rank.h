// The best sum of a few products of one function of the light and one of the view.
#pragma once

#include <span>

#include "codecs/factor_maps/lanes.h"

namespace weft::cmf {

using factor_maps::lane_count;
using factor_maps::Lanes;
using factor_maps::LaneVector;

/// f[light][view] ~ sum over terms of light * view; [term][light] and [term][view].
struct LightView {
  LaneVector light;
  LaneVector view;
};

/// Whether terms may be below zero.
enum class Sign { non_negative, any };

/// First singular pair of each lane's matrix (equation 5 with one term), all values >= 0. The scale
/// is in `light`, the largest of `view` is 1. A lane of zeros gives zeros.
LightView rank_one(const LaneVector& f, std::size_t n_lights, std::size_t n_views);

/// Lowers sum over pairs of w_light (f - P q R)^2 by `rounds` rounds of least squares, P with R
/// held and R with P held; each step is closed and never raises the error. With w = cos^2 that is
/// the error of B = f cos, the one that is seen: in terms of the residual f / q each pair weighs (q
/// cos)^2.
/// @param q              Q at each [light][view] pair.
/// @param light_weights  w_light, > 0, one a light.
LightView weighted_rank_one(const LaneVector& f, const LaneVector& q,
                            std::span<const double> light_weights, int rounds, LightView start);

/// The same with several terms. What `start` lacks of `terms` is begun with the first singular pair
/// of what is left above zero; then all are solved in turn, each with the others held (hierarchical
/// alternating least squares, Cichocki et al. 2007), which never raises the error either.
LightView weighted_low_rank(const LaneVector& f, const LaneVector& q,
                            std::span<const double> light_weights, int terms, Sign sign, int rounds,
                            LightView start);

/// Sum of the terms at each [light][view] pair, raised to 0 where it is less.
LaneVector sum_of_terms(const LightView& factors, std::size_t n_lights, std::size_t n_views);

/// Shares each term's strength evenly between its two functions, so that weak terms lose as little
/// as can be where a factor's terms are scaled together.
void balance_terms(LightView& factors, std::size_t n_lights, std::size_t n_views);

}  // namespace weft::cmf
