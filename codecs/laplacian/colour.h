// YCbCr of linear RGB (BT.601's weights, full range), in which the pyramid's channels are fitted.
#pragma once

#include <array>

#include "btf/vector.h"

namespace weft::laplacian {

/// Rows give Y, Cb and Cr.
inline constexpr std::array<std::array<double, 3>, 3> ycbcr_of_rgb{
    {{0.299, 0.587, 0.114},
     {-0.299 / 1.772, -0.587 / 1.772, 0.5},
     {0.5, -0.587 / 1.402, -0.114 / 1.402}}};

/// R = Y + red_of_cr Cr, G = Y - green_of_cb Cb - green_of_cr Cr, B = Y + blue_of_cb Cb.
inline constexpr float red_of_cr = 1.402F;
inline constexpr float green_of_cb = 0.114F * 1.772F / 0.587F;
inline constexpr float green_of_cr = 0.299F * 1.402F / 0.587F;
inline constexpr float blue_of_cb = 1.772F;

inline Rgb rgb_of_ycbcr(float y, float cb, float cr) {
  return {y + red_of_cr * cr, y - green_of_cb * cb - green_of_cr * cr, y + blue_of_cb * cb};
}

}  // namespace weft::laplacian
