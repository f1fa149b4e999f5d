#include "images/image_file.h"

#include <OpenImageIO/imageio.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string>

#include "btf/atomic_file.h"
#include "btf/error.h"
#include "images/srgb.h"

namespace weft {

namespace {

namespace fs = std::filesystem;

/// OpenImageIO's message on one line; some are long and repeat the file's name, which the caller
/// says anyway.
std::string one_line(std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  while (!message.empty() && std::isspace(static_cast<unsigned char>(message.back()))) {
    message.pop_back();
  }
  return message.empty() ? "no reason given" : message;
}

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool holds_floats(const fs::path& path) {
  static constexpr std::array<const char*, 5> extensions = {".exr", ".sxr", ".hdr", ".rgbe",
                                                            ".pfm"};
  const std::string extension = lower_extension(path);
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const char* e) { return extension == e; });
}

void decode_srgb(Image& image, int alpha_channel) {
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    const int channel = static_cast<int>(i % image.channels);
    if (channel != alpha_channel) image.values[i] = srgb_decoded(image.values[i]);
  }
}

/// Lays what was stored (the data window) into what is meant to be seen (the display window), so
/// that two pictures of one frame agree pixel by pixel even where one was cropped. Zero where
/// nothing was stored.
Image in_display_window(const Image& stored, const OIIO::ImageSpec& spec) {
  Image shown(spec.full_width, spec.full_height, stored.channels);
  for (int y = 0; y < stored.height; ++y) {
    const int row = spec.y - spec.full_y + y;
    if (row < 0 || row >= shown.height) continue;
    const int left = spec.x - spec.full_x;
    const int begin = std::max(0, -left);
    const int end = std::min(stored.width, shown.width - left);
    if (begin >= end) continue;
    std::copy_n(&stored.values[stored.offset(begin, y)],
                static_cast<std::size_t>(end - begin) * stored.channels,
                &shown.values[shown.offset(left + begin, row)]);
  }
  return shown;
}

bool is_cropped(const OIIO::ImageSpec& spec) {
  return spec.full_width > 0 && spec.full_height > 0 &&
         (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
          spec.height != spec.full_height);
}

/// 8-bit pictures cannot hold a NaN, and writing 0 for it would hide it.
void refuse_nan(const fs::path& path, const Image& image) {
  const auto is_nan = [](float v) { return std::isnan(v); };
  const auto first = std::find_if(image.values.begin(), image.values.end(), is_nan);
  if (first == image.values.end()) return;
  const auto count = std::count_if(first, image.values.end(), is_nan);
  const auto pixel = static_cast<int>((first - image.values.begin()) /
                                      static_cast<std::ptrdiff_t>(image.channels));
  throw bad_input(
      path.string(),
      fmt::format("{} values are NaN, which 8 bits cannot hold; the first is at x {}, y {}", count,
                  pixel % image.width, pixel / image.width),
      "write .exr to keep them");
}

std::vector<std::uint8_t> to_bytes(const Image& image, Encoding encoding, int alpha_channel) {
  std::vector<std::uint8_t> bytes(image.values.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    float value = std::clamp(image.values[i], 0.0F, 1.0F);
    const int channel = static_cast<int>(i % image.channels);
    if (encoding == Encoding::colour && channel != alpha_channel) value = srgb_encoded(value);
    bytes[i] = static_cast<std::uint8_t>(std::lround(value * 255.0F));
  }
  return bytes;
}

/// A new writer for a path's format. @throws Error where the extension is none that is known.
std::unique_ptr<OIIO::ImageOutput> writer_for(const fs::path& path) {
  auto output = OIIO::ImageOutput::create(path.string());
  if (!output) {
    const std::string reason = one_line(OIIO::geterror());
    throw bad_input(path.string(),
                    fmt::format("no picture format is known by the extension '{}': {}",
                                path.extension().string(), reason),
                    "use .exr, .hdr, .png, .jpg or .tif");
  }
  return output;
}

OIIO::ImageSpec output_spec(const Image& image, bool floats, FloatSize size) {
  const OIIO::TypeDesc real =
      size == FloatSize::half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT;
  OIIO::ImageSpec spec(image.width, image.height, image.channels,
                       floats ? real : OIIO::TypeDesc::UINT8);
  // Values are stored as they are: no division by alpha, no date (same input, same bytes).
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("DateTime", "");
  spec.attribute("CompressionQuality", 95);
  return spec;
}

}  // namespace

Image read_image(const fs::path& path, Encoding encoding) {
  const std::string name = path.string();
  if (!fs::exists(path)) throw bad_input(name, "no such file");
  if (fs::is_directory(path)) throw bad_input(name, "is a folder, expected a picture");

  OIIO::ImageSpec configuration;
  configuration.attribute("oiio:UnassociatedAlpha", 1);
  auto input = OIIO::ImageInput::open(name, &configuration);
  if (!input) throw bad_input(name, "cannot be read as a picture: " + one_line(OIIO::geterror()));
  const OIIO::ImageSpec spec = input->spec();
  if (spec.depth > 1) throw bad_input(name, "is a volume, expected a flat picture");
  if (spec.deep) throw bad_input(name, "is a deep picture, expected a flat one");

  Image image(spec.width, spec.height, spec.nchannels);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.values.data())) {
    throw bad_input(name, "is truncated or damaged: " + one_line(input->geterror()));
  }
  input->close();
  if (encoding == Encoding::colour && !spec.format.is_floating_point()) {
    decode_srgb(image, spec.alpha_channel);
  }
  return is_cropped(spec) ? in_display_window(image, spec) : image;
}

void check_image_path(const fs::path& path) {
  if (fs::is_directory(path)) throw bad_input(path.string(), "is a folder, expected a picture");
  const fs::path folder = path.parent_path();
  if (!folder.empty() && !fs::is_directory(folder)) {
    throw bad_input(path.string(), "cannot be written: there is no folder " + folder.string());
  }
  writer_for(path);
}

void write_image(const fs::path& path, const Image& image, Encoding encoding, FloatSize size) {
  const bool floats = holds_floats(path);
  if (image.width <= 0 || image.height <= 0 || image.channels <= 0) {
    throw bad_input(path.string(),
                    fmt::format("a picture of {} x {} pixels and {} channels cannot be written",
                                image.width, image.height, image.channels));
  }
  check_image_path(path);
  if (!floats) refuse_nan(path, image);

  const OIIO::ImageSpec spec = output_spec(image, floats, size);
  const std::vector<std::uint8_t> bytes =
      floats ? std::vector<std::uint8_t>() : to_bytes(image, encoding, spec.alpha_channel);
  write_atomically(path, [&](const fs::path& aside) {
    const auto output = writer_for(aside);
    const bool written = output->open(aside.string(), spec) &&
                         (floats ? output->write_image(OIIO::TypeDesc::FLOAT, image.values.data())
                                 : output->write_image(OIIO::TypeDesc::UINT8, bytes.data())) &&
                         output->close();
    if (!written) {
      throw failed(path.string(), "cannot be written: " + one_line(output->geterror()));
    }
  });
}

}  // namespace weft
