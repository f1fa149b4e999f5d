// A perceptually uniform colour scale, and error maps drawn with it beside a legend.
#pragma once

#include <string>

#include "images/image.h"

namespace weft {

/// Linear colour (displayed by writing it sRGB-encoded) of `t`, clamped to [0, 1]: dark purple,
/// blue, teal, green, yellow. The scale is an arc of a helix in OKLab (Ottosson 2020) at constant
/// speed: its lightness rises in equal steps, so that it reads in grey too, and equal steps of `t`
/// are equal steps of perceived difference.
Rgb scale_colour(double t);

/// OKLab coordinates (L, a, b) of a linear Rec. 709 colour, and back.
Vec3 oklab(const Rgb& linear);
Rgb linear_from_oklab(const Vec3& lab);

/// The 99.5th percentile of the values, rounded up to 1, 2 or 5 times a power of ten, so that a few
/// outliers do not darken a whole map; 1 where no value is above zero.
double scale_top(const Image& values);

/// @param values  one channel, finite, >= 0.
/// @param top     value of the brightest colour, > 0; what is above has that colour too, and the
/// legend says so.
/// @param unit    stands above the legend's bar.
/// @return the map, with the bar and its numbered ticks to its right, on white. Linear colours.
Image draw_colour_map(const Image& values, double top, const std::string& unit);

}  // namespace weft
