// The YUV in which UBO2014's files are decorrelated (their color_model 11).
#pragma once

#include <array>

#include "btf/vector.h"

namespace weft::dfmf {

/// Rows give Y, U and V of linear RGB.
inline constexpr std::array<std::array<float, 3>, 3> yuv_of_rgb{
    {{0.299F, 0.587F, 0.114F}, {-0.14713F, -0.28886F, 0.436F}, {0.615F, -0.51499F, -0.10001F}}};

inline constexpr float red_of_v = 1.13983F;
inline constexpr float green_of_u = 0.39465F;
inline constexpr float green_of_v = 0.58060F;
inline constexpr float blue_of_u = 2.03211F;

}  // namespace weft::dfmf
