// Text drawn into pictures, for legends.
#pragma once

#include <filesystem>
#include <string>

#include "images/image.h"

namespace weft {

enum class TextAlignment { left, centre, right };

/// Draws one line of printable ASCII, antialiased, its vertical middle at `y` and its left edge,
/// middle or right edge at `x`. What falls outside the picture is cut. `size` is the height of an
/// em in pixels; `colour` is linear.
/// @throws Error  failed, where no font is found on this machine (see `font_file`); bad_input for
/// other characters.
void draw_text(Image& image, int x, int y, const std::string& text, int size, const Rgb& colour,
               TextAlignment alignment = TextAlignment::left);

/// Width in pixels that `draw_text` covers. @throws Error as `draw_text`.
int text_width(const std::string& text, int size);

/// The font used: $WEFT_FONT, else DejaVuSans.ttf in the font folders of this machine
/// ($XDG_DATA_HOME, $XDG_DATA_DIRS, ~/.fonts), else the first TrueType or OpenType file there, by
/// name.
/// @throws Error  failed, naming the folders searched and the package to install.
std::filesystem::path font_file();

}  // namespace weft
