// Luminance of linear Rec. 709.
#pragma once

#include <array>

namespace weft {

inline constexpr std::array<double, 3> luminance_of_rgb{0.2126, 0.7152, 0.0722};

}  // namespace weft
