#include "images/text.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <system_error>
#include <vector>

#include "btf/error.h"

namespace weft {

namespace {

namespace fs = std::filesystem;

std::string environment(const char* name, const std::string& fallback = {}) {
  const char* value = std::getenv(name);
  return value == nullptr || *value == '\0' ? fallback : value;
}

/// The folders where freedesktop systems keep fonts, the user's own first.
std::vector<fs::path> font_folders() {
  const std::string home = environment("HOME");
  std::vector<fs::path> folders;
  const std::string data_home =
      environment("XDG_DATA_HOME", home.empty() ? "" : home + "/.local/share");
  if (!data_home.empty()) folders.push_back(fs::path(data_home) / "fonts");
  if (!home.empty()) folders.push_back(fs::path(home) / ".fonts");
  std::istringstream data_dirs(environment("XDG_DATA_DIRS", "/usr/local/share:/usr/share"));
  for (std::string folder; std::getline(data_dirs, folder, ':');) {
    folders.push_back(fs::path(folder) / "fonts");
  }
  folders.emplace_back("/usr/share/fonts");  // also where XDG_DATA_DIRS leaves it out
  return folders;
}

/// DejaVuSans.ttf under `folder`, else the first font by path; nothing where there is none.
std::optional<fs::path> font_below(const fs::path& folder) {
  std::optional<fs::path> first;
  std::error_code unreadable;
  for (fs::recursive_directory_iterator
           it(folder, fs::directory_options::skip_permission_denied, unreadable),
       end;
       !unreadable && it != end; it.increment(unreadable)) {
    const fs::path& path = it->path();
    if (path.filename() == "DejaVuSans.ttf") return path;
    const bool is_font = path.extension() == ".ttf" || path.extension() == ".otf";
    if (is_font && (!first || path < *first)) first = path;
  }
  return first;
}

fs::path search_font() {
  const std::string chosen = environment("WEFT_FONT");
  if (!chosen.empty()) {
    if (!fs::is_regular_file(chosen)) throw failed("WEFT_FONT", "no such file: " + chosen);
    return chosen;
  }
  std::optional<fs::path> any;
  std::string searched;
  for (const fs::path& folder : font_folders()) {
    const std::optional<fs::path> found = font_below(folder);
    if (found && found->filename() == "DejaVuSans.ttf") return *found;
    if (found && !any) any = found;
    searched += (searched.empty() ? "" : ", ") + folder.string();
  }
  if (any) return *any;
  throw failed("legend", "no font was found in " + searched,
               "install the package fonts-dejavu-core, or name a .ttf file in WEFT_FONT");
}

/// OpenImageIO 2.4 draws other glyphs than meant for what takes more than one byte.
void refuse_beyond_ascii(const std::string& text) {
  const bool ascii =
      std::all_of(text.begin(), text.end(), [](unsigned char c) { return c >= 32 && c < 127; });
  if (!ascii) throw bad_input("text '" + text + "'", "only ASCII can be drawn into pictures");
}

OIIO::ImageBufAlgo::TextAlignX align_x(TextAlignment alignment) {
  using OIIO::ImageBufAlgo::TextAlignX;
  switch (alignment) {
    case TextAlignment::left:
      return TextAlignX::Left;
    case TextAlignment::centre:
      return TextAlignX::Center;
    case TextAlignment::right:
      return TextAlignX::Right;
  }
  return TextAlignX::Left;
}

}  // namespace

fs::path font_file() {
  static const fs::path found = search_font();
  return found;
}

void draw_text(Image& image, int x, int y, const std::string& text, int size, const Rgb& colour,
               TextAlignment alignment) {
  refuse_beyond_ascii(text);
  const std::string font = font_file().string();
  OIIO::ImageBuf canvas(
      OIIO::ImageSpec(image.width, image.height, image.channels, OIIO::TypeDesc::FLOAT),
      image.values.data());
  std::vector<float> ink(image.channels, 1.0F);
  for (int c = 0; c < std::min(3, image.channels); ++c) ink[c] = colour[c];
  if (!OIIO::ImageBufAlgo::render_text(canvas, x, y, text, size, font, ink, align_x(alignment),
                                       OIIO::ImageBufAlgo::TextAlignY::Center)) {
    throw failed("text '" + text + "'", "cannot be drawn: " + canvas.geterror(), "font " + font);
  }
}

int text_width(const std::string& text, int size) {
  refuse_beyond_ascii(text);
  const std::string font = font_file().string();
  const OIIO::ROI extent = OIIO::ImageBufAlgo::text_size(text, size, font);
  if (!extent.defined()) throw failed("text '" + text + "'", "cannot be measured", "font " + font);
  return extent.width();
}

}  // namespace weft
