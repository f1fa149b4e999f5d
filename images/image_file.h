// Other people's pictures in and out, through OpenImageIO (no header of it is needed to call
// these).
#pragma once

#include <filesystem>

#include "images/image.h"

namespace weft {

/// How 8- and 16-bit values are taken: as stored in 0..1 (`linear`), or decoded from sRGB
/// (`colour`). Float and half files are linear either way.
enum class Encoding { linear, colour };

/// What one number of an `.exr` is; other formats have their own.
enum class FloatSize { full, half };

/// Reads the first image of any file that OpenImageIO knows.
/// @throws Error  naming the file and why (missing, truncated, unknown format).
Image read_image(const std::filesystem::path& path, Encoding encoding);

/// To be asked before minutes of work whose picture goes to `path`.
/// @throws Error  bad_input, where its folder is not there, it is a folder itself, or its extension
///                is of no format that can be written.
void check_image_path(const std::filesystem::path& path);

/// Format by extension. `.exr` and `.hdr` hold linear floats; `.png`, `.jpg` and other 8-bit
/// formats are sRGB-encoded with `Encoding::colour` and raw bytes (value * 255, rounded) with
/// `Encoding::linear`. Written aside and renamed. @throws Error naming the file.
void write_image(const std::filesystem::path& path, const Image& image, Encoding encoding,
                 FloatSize size = FloatSize::full);

}  // namespace weft
